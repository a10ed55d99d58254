// The light of a directional lightmap in mode mono-sh. Scales: of the mean light times π, of the direction.
// needs: directional-mono-sh
// given: fn irradia_sh_mean_sample(uv: vec2f, layer: f32) -> vec4f
// given: fn irradia_sh_direction_sample(uv: vec2f, layer: f32) -> vec4f
// given: var<uniform> irradia_map_scales: array<vec4f>

fn irradia_light(
    normal: vec3f,
    surface_normal: vec3f,
    lightmap_uv: vec2f,
    page: f32,
) -> vec3f {
    let mean = irradia_sh_mean_sample(lightmap_uv, page).rgb * irradia_map_scales[0].x;
    let coded = irradia_sh_direction_sample(lightmap_uv, page).rgb * irradia_map_scales[0].y;
    return mean * irradia_mono_lobe(2.0 * coded - 1.0, normal, surface_normal);
}
