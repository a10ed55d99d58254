// Generated from shaders/wgsl/light-irradiance.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, head

float3 irradia_light(float3 position, float3 normal)
{
    irradia_run(position, normal);
    const float4 _e3 = irradia_output(0u);
    const float3 _e5 = irradia_head(_e3.xyz);
    const float4 _e7 = irradia_constant(0u);
    float3 light = _e5 * _e7.w;
    return max(light, (0.0).xxx);
}

float3 irradia_view_unclamped(float3 position, float3 normal)
{
    irradia_run(position, normal);
    const float4 _e3 = irradia_output(0u);
    const float3 _e5 = irradia_head_unclamped(_e3.xyz);
    const float4 _e7 = irradia_constant(0u);
    return _e5 * _e7.w;
}
