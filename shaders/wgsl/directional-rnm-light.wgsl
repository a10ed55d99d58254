// The light of a directional lightmap in mode rnm. Scales: of the three maps, times π.
// needs: directional-rnm
// given: fn irradia_rnm_a_sample(uv: vec2f, layer: f32) -> vec4f
// given: fn irradia_rnm_b_sample(uv: vec2f, layer: f32) -> vec4f
// given: fn irradia_rnm_c_sample(uv: vec2f, layer: f32) -> vec4f
// given: var<uniform> irradia_map_scales: array<vec4f>

fn irradia_light(
    normal: vec3f,
    surface_normal: vec3f,
    tangent: vec4f,
    lightmap_uv: vec2f,
    page: f32,
) -> vec3f {
    let weights = irradia_rnm_weights(normal, surface_normal, tangent) * irradia_map_scales[0].xyz;
    let a = irradia_rnm_a_sample(lightmap_uv, page).rgb;
    let b = irradia_rnm_b_sample(lightmap_uv, page).rgb;
    let c = irradia_rnm_c_sample(lightmap_uv, page).rgb;
    return max(weights.x * a + weights.y * b + weights.z * c, vec3f(0.0));
}
