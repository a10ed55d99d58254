// Rectified linear units.

fn irradia_activation(z: vec4f) -> vec4f {
    return max(z, vec4f(0.0));
}
