// E of a field that gives radiance as spherical harmonics up to L2: 27 outputs, (coefficient, channel) flattened.
// needs: field, cosine-lobe

fn irradia_view_unclamped(position: vec3f, normal: vec3f) -> vec3f {
    irradia_run(position, normal);
    let linear = irradia_lobe_linear(normal);
    let quadratic = irradia_lobe_quadratic(normal);
    var light = vec3f(0.0);
    // Four coefficients are three vec4s: twice the same, so a loop.
    for (var three = 0u; three < 6u; three += 3u) {
        let weights = select(quadratic, linear, three == 0u);
        let a = irradia_output(three);
        let b = irradia_output(three + 1u);
        let c = irradia_output(three + 2u);
        light += weights.x * a.xyz;
        light += weights.y * vec3f(a.w, b.xy);
        light += weights.z * vec3f(b.zw, c.x);
        light += weights.w * c.yzw;
    }
    light += irradia_lobe_squares(normal) * irradia_output(6u).xyz;
    return light * irradia_constant(0u).w;
}

// E in W·m⁻², linear Rec.709; position in metres, normal of unit length.
fn irradia_light(position: vec3f, normal: vec3f) -> vec3f {
    return max(irradia_view_unclamped(position, normal), vec3f(0.0));
}
