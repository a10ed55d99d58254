// What the lights themselves give, from a map of their first bounces: to be added to indirect light.
// given: fn irradia_direct_sample(uv: vec2f, layer: f32) -> vec4f
// given: var<uniform> irradia_direct_scale: array<vec4f>

fn irradia_direct_light(lightmap_uv: vec2f, page: f32) -> vec3f {
    let texel = irradia_direct_sample(lightmap_uv, page).rgb;
    return max(texel * irradia_direct_scale[0].x, vec3f(0.0));
}
