// Generated from shaders/wgsl/light-sh1.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, cosine-lobe

metal::float3 irradia_view_unclamped(
    metal::float3 position,
    metal::float3 normal
) {
    irradia_run(position, normal);
    metal::float4 _e3 = irradia_output(0u);
    metal::float4 _e5 = irradia_output(1u);
    metal::float4 _e7 = irradia_output(2u);
    metal::float4 _e8 = irradia_lobe_linear(normal);
    metal::float3 light = (((_e8.x * _e3.xyz) + (_e8.y * metal::float3(_e3.w, _e5.xy))) + (_e8.z * metal::float3(_e5.zw, _e7.x))) + (_e8.w * _e7.yzw);
    metal::float4 _e29 = irradia_constant(0u);
    return light * _e29.w;
}

metal::float3 irradia_light(
    metal::float3 position,
    metal::float3 normal
) {
    metal::float3 _e2 = irradia_view_unclamped(position, normal);
    return metal::max(_e2, metal::float3(0.0));
}
