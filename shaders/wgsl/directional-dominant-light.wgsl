// The light of a directional lightmap in mode dominant. Scales: of the plain map times π, of the direction.
// needs: directional-dominant
// given: fn irradia_lightmap_sample(uv: vec2f, layer: f32) -> vec4f
// given: fn irradia_direction_sample(uv: vec2f, layer: f32) -> vec4f
// given: var<uniform> irradia_map_scales: array<vec4f>

fn irradia_light(
    normal: vec3f,
    surface_normal: vec3f,
    lightmap_uv: vec2f,
    page: f32,
) -> vec3f {
    let plain = irradia_lightmap_sample(lightmap_uv, page).rgb * irradia_map_scales[0].x;
    let coded = irradia_direction_sample(lightmap_uv, page).rgb * irradia_map_scales[0].y;
    let share = irradia_dominant_share(2.0 * coded - 1.0, normal, surface_normal);
    return max(plain * share, vec3f(0.0));
}
