// Which probes of an octree lie around a place: the corners of the leaf that holds it.
//
// `irradia_probe_cells` is a list of words. First the lattice of roots, x fastest, then eight children for each
// inner node, then eight probes for each leaf. A word's top bits say what it is: 0 an inner node, by its first
// child, 1 a leaf, by its number, 2 nothing, and which of its siblings is nearest and something: the child's number,
// or ten bits each for a root's x, y and z.
// needs: probes
// given: var irradia_probe_cells: texture_2d_array<u32>
// given: var<uniform> irradia_probe_layout: array<vec4f>

// A word of the list; sides of its texture are powers of two.
fn irradia_probe_cell_word(index: u32) -> u32 {
    let shifts = vec2u(irradia_probe_layout[4].zw);
    let x = index & ((1u << shifts.x) - 1u);
    let row = index >> shifts.x;
    let y = row & ((1u << shifts.y) - 1u);
    return textureLoad(irradia_probe_cells, vec2i(vec2u(x, y)), i32(row >> shifts.y), 0).x;
}

// A place's leaf: how far along each axis the place is in it, in [0, 1], and its number. Where there is no leaf,
// a neighbouring one and the place in it that is nearest.
fn irradia_probe_cell(position: vec3f) -> vec4f {
    let shape = irradia_probe_layout[2].xyz;
    let at = (position - irradia_probe_layout[0].xyz) / irradia_probe_layout[1].xyz;
    var low = clamp(floor(at), vec3f(0.0), shape - 1.0);
    var word = irradia_probe_cell_word(u32(low.x + shape.x * (low.y + shape.y * low.z)));
    if (word >> 30u) == 2u {
        low = vec3f(vec3u(word & 1023u, (word >> 10u) & 1023u, (word >> 20u) & 1023u));
        word = irradia_probe_cell_word(u32(low.x + shape.x * (low.y + shape.y * low.z)));
    }
    var share = clamp(at - low, vec3f(0.0), vec3f(1.0));
    for (var level = 0u; level < 15u; level++) {
        if (word >> 30u) != 0u {
            break;
        }
        let first = word;
        low = min(floor(2.0 * share), vec3f(1.0));
        word = irradia_probe_cell_word(first + u32(low.x + 2.0 * low.y + 4.0 * low.z));
        if (word >> 30u) == 2u {
            let child = word & 7u;
            low = vec3f(vec3u(child & 1u, (child >> 1u) & 1u, child >> 2u));
            word = irradia_probe_cell_word(first + child);
        }
        share = clamp(2.0 * share - low, vec3f(0.0), vec3f(1.0));
    }
    return vec4f(share, f32(word & 0x3fffffffu));
}

// The probe at a corner of a leaf, or 0xffffffff; bit 0 of the corner's number is +x, bit 1 +y, bit 2 +z.
fn irradia_probe_corner(cell: f32, corner: u32) -> u32 {
    return irradia_probe_cell_word(u32(irradia_probe_layout[0].w) + 8u * u32(cell) + corner);
}
