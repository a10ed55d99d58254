// Generated from shaders/wgsl/light-sh2.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, cosine-lobe

float3 irradia_view_unclamped(float3 position, float3 normal)
{
    float3 light = (0.0).xxx;

    irradia_run(position, normal);
    const float4 _e2 = irradia_lobe_linear(normal);
    const float4 _e3 = irradia_lobe_quadratic(normal);
    for (uint three = 0u; three < 6u; three += 3u) {
        uint _e12 = three;
        float4 weights = ((_e12 == 0u) ? _e2 : _e3);
        uint _e16 = three;
        const float4 _e17 = irradia_output(_e16);
        uint _e18 = three;
        const float4 _e21 = irradia_output((_e18 + 1u));
        uint _e22 = three;
        const float4 _e25 = irradia_output((_e22 + 2u));
        float3 _e26 = light;
        light = (_e26 + (weights.x * _e17.xyz));
        float3 _e31 = light;
        light = (_e31 + (weights.y * float3(_e17.w, _e21.xy)));
        float3 _e38 = light;
        light = (_e38 + (weights.z * float3(_e21.zw, _e25.x)));
        float3 _e45 = light;
        light = (_e45 + (weights.w * _e25.yzw));
    }
    float3 _e53 = light;
    const float _e54 = irradia_lobe_squares(normal);
    const float4 _e56 = irradia_output(6u);
    light = (_e53 + (_e54 * _e56.xyz));
    float3 _e60 = light;
    const float4 _e62 = irradia_constant(0u);
    return (_e60 * _e62.w);
}

float3 irradia_light(float3 position, float3 normal)
{
    const float3 _e2 = irradia_view_unclamped(position, normal);
    return max(_e2, (0.0).xxx);
}
