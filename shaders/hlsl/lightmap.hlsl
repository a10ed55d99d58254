// Generated from shaders/wgsl/lightmap.wgsl by `npm run shaders` in web/: don't edit.

float3 irradia_lightmap_irradiance(float3 texel, float scale)
{
    return max((texel * scale), (0.0).xxx);
}
