// Directional lightmaps, mode dominant: the plain map, shaded by half a Lambert. docs/directional.md

// What a normal gets, as a share of what the surface's own gets. `direction` is decoded: within [-1, 1].
fn irradia_dominant_share(direction: vec3f, normal: vec3f, surface_normal: vec3f) -> f32 {
    let lit = max(0.5 + 0.5 * dot(normal, direction), 0.0);
    let own = max(0.5 + 0.5 * dot(surface_normal, direction), 1e-4);
    return lit / own;
}
