// The list of vec4s that holds all numbers of one field: here in a texture of 256 columns, for lists that are too
// long for a uniform buffer. The blocks of a matrix row lie side by side, so that reading one row runs along a row.
// given: var irradia_constants: texture_2d_array<f32>

fn irradia_constant(at: u32) -> vec4f {
    return textureLoad(irradia_constants, vec2u(at & 255u, at >> 8u), 0, 0);
}
