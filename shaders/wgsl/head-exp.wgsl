// Outputs are logarithms.

fn irradia_head(z: vec3f) -> vec3f {
    return exp(clamp(z, vec3f(-15.0), vec3f(15.0)));
}

fn irradia_head_unclamped(z: vec3f) -> vec3f {
    return exp(z);
}
