// Generated from shaders/wgsl/lightmap-light.wgsl by `npm run shaders` in web/: don't edit.
// needs: lightmap
// given, in WGSL: fn irradia_lightmap_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: var<uniform> irradia_map_scales: array<vec4f>

vec3 irradia_light(vec2 lightmap_uv, float page) {
    vec4 _e2 = irradia_lightmap_sample(lightmap_uv, page);
    vec3 texel = _e2.xyz;
    float _e7 = irradia_map_scales[0].x;
    vec3 _e8 = irradia_lightmap_irradiance(texel, _e7);
    return _e8;
}
