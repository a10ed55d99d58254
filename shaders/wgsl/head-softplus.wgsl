// log(1 + exp z).

fn irradia_head(z: vec3f) -> vec3f {
    let e = exp(-abs(z));
    // Where e is small 1 + e forgets most of it.
    return max(z, vec3f(0.0)) + select(log(1.0 + e), e - 0.5 * e * e, e < vec3f(0.001));
}

fn irradia_head_unclamped(z: vec3f) -> vec3f {
    return irradia_head(z);
}
