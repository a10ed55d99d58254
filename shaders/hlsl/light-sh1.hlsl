// Generated from shaders/wgsl/light-sh1.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, cosine-lobe

float3 irradia_view_unclamped(float3 position, float3 normal)
{
    irradia_run(position, normal);
    const float4 _e3 = irradia_output(0u);
    const float4 _e5 = irradia_output(1u);
    const float4 _e7 = irradia_output(2u);
    const float4 _e8 = irradia_lobe_linear(normal);
    float3 light = (((_e8.x * _e3.xyz) + (_e8.y * float3(_e3.w, _e5.xy))) + (_e8.z * float3(_e5.zw, _e7.x))) + (_e8.w * _e7.yzw);
    const float4 _e29 = irradia_constant(0u);
    return light * _e29.w;
}

float3 irradia_light(float3 position, float3 normal)
{
    const float3 _e2 = irradia_view_unclamped(position, normal);
    return max(_e2, (0.0).xxx);
}
