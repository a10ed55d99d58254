// E of a field that gives radiance as spherical harmonics up to L1: twelve outputs, (coefficient, channel) flattened.
// needs: field, cosine-lobe

fn irradia_view_unclamped(position: vec3f, normal: vec3f) -> vec3f {
    irradia_run(position, normal);
    let a = irradia_output(0u);
    let b = irradia_output(1u);
    let c = irradia_output(2u);
    let weights = irradia_lobe_linear(normal);
    let light = weights.x * a.xyz
        + weights.y * vec3f(a.w, b.xy)
        + weights.z * vec3f(b.zw, c.x)
        + weights.w * c.yzw;
    return light * irradia_constant(0u).w;
}

// E in W·m⁻², linear Rec.709; position in metres, normal of unit length.
fn irradia_light(position: vec3f, normal: vec3f) -> vec3f {
    return max(irradia_view_unclamped(position, normal), vec3f(0.0));
}
