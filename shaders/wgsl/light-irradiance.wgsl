// E of a field that was trained on E.
// needs: field, head

// E in W·m⁻², linear Rec.709; position in metres, normal of unit length.
fn irradia_light(position: vec3f, normal: vec3f) -> vec3f {
    irradia_run(position, normal);
    let light = irradia_head(irradia_output(0u).xyz) * irradia_constant(0u).w;
    return max(light, vec3f(0.0));
}

// For debugging: light before it is limited from above and below.
fn irradia_view_unclamped(position: vec3f, normal: vec3f) -> vec3f {
    irradia_run(position, normal);
    return irradia_head_unclamped(irradia_output(0u).xyz) * irradia_constant(0u).w;
}
