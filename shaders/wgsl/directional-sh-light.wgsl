// The light of a directional lightmap in mode sh. Scales: of the mean light times π, of x, y and z.
// needs: directional-sh
// given: fn irradia_sh_mean_sample(uv: vec2f, layer: f32) -> vec4f
// given: fn irradia_sh_x_sample(uv: vec2f, layer: f32) -> vec4f
// given: fn irradia_sh_y_sample(uv: vec2f, layer: f32) -> vec4f
// given: fn irradia_sh_z_sample(uv: vec2f, layer: f32) -> vec4f
// given: var<uniform> irradia_map_scales: array<vec4f>

fn irradia_light(
    normal: vec3f,
    surface_normal: vec3f,
    lightmap_uv: vec2f,
    page: f32,
) -> vec3f {
    let scales = irradia_map_scales[0];
    let mean = irradia_sh_mean_sample(lightmap_uv, page).rgb * scales.x;
    let x = 2.0 * scales.y * irradia_sh_x_sample(lightmap_uv, page).rgb - 1.0;
    let y = 2.0 * scales.z * irradia_sh_y_sample(lightmap_uv, page).rgb - 1.0;
    let z = 2.0 * scales.w * irradia_sh_z_sample(lightmap_uv, page).rgb - 1.0;
    return mean * irradia_sh_lobes(x, y, z, normal, surface_normal);
}
