// Directional lightmaps, mode sh: mean light and its mean direction, colour by colour. docs/directional.md

// E/π over the mean light, by colour. x, y and z hold the directions' components, decoded: within [-1, 1].
fn irradia_sh_lobes(
    x: vec3f,
    y: vec3f,
    z: vec3f,
    normal: vec3f,
    surface_normal: vec3f,
) -> vec3f {
    let t = 2.0 * (x * normal.x + y * normal.y + z * normal.z);
    let r = min(sqrt(x * x + y * y + z * z), vec3f(1.0));
    let cosine = dot(normal, surface_normal);
    let bent = max(1.0 - cosine * cosine, 0.0);
    return max(t + sqrt(t * t + (1.0 - r) * (1.0 + 2.0 * r) * bent), vec3f(0.0));
}
