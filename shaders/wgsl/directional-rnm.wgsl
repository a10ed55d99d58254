// Directional lightmaps, mode rnm: light towards three axes of tangent space. docs/directional.md

// How much each of the three maps counts. `tangent.w` is the bitangent's sign, as in glTF.
fn irradia_rnm_weights(normal: vec3f, surface_normal: vec3f, tangent: vec4f) -> vec3f {
    let bitangent = cross(surface_normal, tangent.xyz) * tangent.w;
    let t = vec3f(dot(normal, tangent.xyz), dot(normal, bitangent), dot(normal, surface_normal));
    let along = 0.57735026919 * t.z;
    let cosines = vec3f(
        0.81649658093 * t.x + along,
        -0.40824829046 * t.x + 0.70710678119 * t.y + along,
        -0.40824829046 * t.x - 0.70710678119 * t.y + along,
    );
    return max(cosines, vec3f(0.0));
}
