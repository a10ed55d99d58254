// Generated from shaders/wgsl/directional-rnm-light.wgsl by `npm run shaders` in web/: don't edit.
// needs: directional-rnm
// given, in WGSL: fn irradia_rnm_a_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_rnm_b_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_rnm_c_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: var<uniform> irradia_map_scales: array<vec4f>

vec3 irradia_light(vec3 normal, vec3 surface_normal, vec4 tangent, vec2 lightmap_uv, float page) {
    vec3 _e5 = irradia_rnm_weights(normal, surface_normal, tangent);
    vec3 weights = _e5 * irradia_map_scales[0].xyz;
    vec4 _e11 = irradia_rnm_a_sample(lightmap_uv, page);
    vec3 a = _e11.xyz;
    vec4 _e13 = irradia_rnm_b_sample(lightmap_uv, page);
    vec3 b = _e13.xyz;
    vec4 _e15 = irradia_rnm_c_sample(lightmap_uv, page);
    vec3 c = _e15.xyz;
    return max((((weights.x * a) + (weights.y * b)) + (weights.z * c)), vec3(0.0));
}
