// Shadow masks of mixed lights: multiply a light's unshadowed light by this. docs/shadow_mask.md

// The share of a light that arrives. `mask` is the mask's texel; a negative `channel` is a light without one.
fn irradia_shadow(mask: vec4f, channel: i32) -> f32 {
    let lights = vec4i(0, 1, 2, 3);
    let own = select(vec4f(0.0), mask, lights == vec4i(channel));
    return select(own.x + own.y + own.z + own.w, 1.0, channel < 0);
}
