// Generated from shaders/wgsl/lightmap.wgsl by `npm run shaders` in web/: don't edit.

metal::float3 irradia_lightmap_irradiance(
    metal::float3 texel,
    float scale
) {
    return metal::max(texel * scale, metal::float3(0.0));
}
