// Sines of what may be many turns; the frequency is in the first weights.
// needs: sine

fn irradia_activation(z: vec4f) -> vec4f {
    return irradia_sine(z);
}
