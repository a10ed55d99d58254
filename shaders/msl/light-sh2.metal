// Generated from shaders/wgsl/light-sh2.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, cosine-lobe

metal::float3 irradia_view_unclamped(
    metal::float3 position,
    metal::float3 normal
) {
    metal::float3 light = metal::float3(0.0);
    irradia_run(position, normal);
    metal::float4 _e2 = irradia_lobe_linear(normal);
    metal::float4 _e3 = irradia_lobe_quadratic(normal);
    for (uint three = 0u; three < 6u; three += 3u) {
        metal::float4 weights = (three == 0u) ? _e2 : _e3;
        metal::float4 _e17 = irradia_output(three);
        metal::float4 _e21 = irradia_output(three + 1u);
        metal::float4 _e25 = irradia_output(three + 2u);
        light = light + (weights.x * _e17.xyz);
        light = light + (weights.y * metal::float3(_e17.w, _e21.xy));
        light = light + (weights.z * metal::float3(_e21.zw, _e25.x));
        light = light + (weights.w * _e25.yzw);
    }
    float _e54 = irradia_lobe_squares(normal);
    metal::float4 _e56 = irradia_output(6u);
    light = light + (_e54 * _e56.xyz);
    metal::float4 _e62 = irradia_constant(0u);
    return light * _e62.w;
}

metal::float3 irradia_light(
    metal::float3 position,
    metal::float3 normal
) {
    metal::float3 _e2 = irradia_view_unclamped(position, normal);
    return metal::max(_e2, metal::float3(0.0));
}
