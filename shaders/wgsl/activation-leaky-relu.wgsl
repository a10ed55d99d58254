// Leaky rectified linear units, slope 0.01 below 0.

fn irradia_activation(z: vec4f) -> vec4f {
    return max(z, 0.01 * z);
}
