// Generated from shaders/wgsl/light-irradiance.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, head

metal::float3 irradia_light(
    metal::float3 position,
    metal::float3 normal
) {
    irradia_run(position, normal);
    metal::float4 _e3 = irradia_output(0u);
    metal::float3 _e5 = irradia_head(_e3.xyz);
    metal::float4 _e7 = irradia_constant(0u);
    metal::float3 light = _e5 * _e7.w;
    return metal::max(light, metal::float3(0.0));
}

metal::float3 irradia_view_unclamped(
    metal::float3 position,
    metal::float3 normal
) {
    irradia_run(position, normal);
    metal::float4 _e3 = irradia_output(0u);
    metal::float3 _e5 = irradia_head_unclamped(_e3.xyz);
    metal::float4 _e7 = irradia_constant(0u);
    return _e5 * _e7.w;
}
