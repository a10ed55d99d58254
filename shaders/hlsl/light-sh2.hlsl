// Generated from shaders/wgsl/light-sh2.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, cosine-lobe

float3 irradia_view_unclamped(float3 position, float3 normal)
{
    float3 light = (0.0).xxx;

    irradia_run(position, normal);
    const float4 _e2 = irradia_lobe_linear(normal);
    const float4 _e3 = irradia_lobe_quadratic(normal);
    for (uint three = 0u; three < 6u; three += 3u) {
        float4 weights = (three == 0u) ? _e2 : _e3;
        const float4 _e17 = irradia_output(three);
        const float4 _e21 = irradia_output((three + 1u));
        const float4 _e25 = irradia_output((three + 2u));
        light = light + (weights.x * _e17.xyz);
        light = light + (weights.y * float3(_e17.w, _e21.xy));
        light = light + (weights.z * float3(_e21.zw, _e25.x));
        light = light + (weights.w * _e25.yzw);
    }
    const float _e54 = irradia_lobe_squares(normal);
    const float4 _e56 = irradia_output(6u);
    light = light + (_e54 * _e56.xyz);
    const float4 _e62 = irradia_constant(0u);
    return light * _e62.w;
}

float3 irradia_light(float3 position, float3 normal)
{
    const float3 _e2 = irradia_view_unclamped(position, normal);
    return max(_e2, (0.0).xxx);
}
