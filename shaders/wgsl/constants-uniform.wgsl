// The list of vec4s that holds all numbers of one field: here in a uniform buffer.
// given: var<uniform> irradia_constants: array<vec4f>

fn irradia_constant(at: u32) -> vec4f {
    return irradia_constants[at];
}
