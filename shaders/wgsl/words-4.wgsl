// A table of which a texel is 4 words (rgba32uint).
// All names that begin with irradia_table belong to one table; for a field's second table every such piece comes once
// more, with irradia_table_b instead.
// given: var irradia_table: texture_2d_array<u32>

const irradia_table_words: u32 = 4u;

// A texel's words. Entries begin with texels here, so nothing is ever shifted.
fn irradia_table_texel(at: vec3u, shift: u32) -> vec4u {
    return textureLoad(irradia_table, at.xy, at.z, 0);
}
