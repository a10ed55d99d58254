// Directional lightmaps, mode mono-sh: mean light, and one mean direction for all colours. docs/directional.md

// E/π over the mean light. `direction` is decoded: within [-1, 1].
fn irradia_mono_lobe(direction: vec3f, normal: vec3f, surface_normal: vec3f) -> f32 {
    let t = 2.0 * dot(direction, normal);
    let r = min(length(direction), 1.0);
    let cosine = dot(normal, surface_normal);
    let bent = max(1.0 - cosine * cosine, 0.0);
    return max(t + sqrt(t * t + (1.0 - r) * (1.0 + 2.0 * r) * bent), 0.0);
}
