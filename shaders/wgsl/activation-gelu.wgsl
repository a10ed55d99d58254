// The tanh form of GELU (Hendrycks and Gimpel 2016), with ½ (1 + tanh u) = 1 / (1 + exp(−2 u)): some devices'
// tanh gives no number where the argument is large.

fn irradia_activation(z: vec4f) -> vec4f {
    // 2 √(2/π)
    let twice = 1.5957691216057308 * (z + 0.044715 * z * z * z);
    return z / (1.0 + exp(min(-twice, vec4f(80.0))));
}
