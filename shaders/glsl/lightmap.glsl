// Generated from shaders/wgsl/lightmap.wgsl by `npm run shaders` in web/: don't edit.

vec3 irradia_lightmap_irradiance(vec3 texel, float scale) {
    return max((texel * scale), vec3(0.0));
}
