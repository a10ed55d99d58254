// z · sigmoid(z), also known as swish.

fn irradia_activation(z: vec4f) -> vec4f {
    // Below −80 the result is 0 in floats; the exponential would be infinite, which fast arithmetic may not respect.
    return z / (1.0 + exp(min(-z, vec4f(80.0))));
}
