// The light of a plain lightmap.
// needs: lightmap
// given: fn irradia_lightmap_sample(uv: vec2f, layer: f32) -> vec4f
// given: var<uniform> irradia_map_scales: array<vec4f>

fn irradia_light(lightmap_uv: vec2f, page: f32) -> vec3f {
    let texel = irradia_lightmap_sample(lightmap_uv, page).rgb;
    return irradia_lightmap_irradiance(texel, irradia_map_scales[0].x);
}
