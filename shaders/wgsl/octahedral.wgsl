// The sphere on a square, with +Y in its middle: u runs along +X, v along +Z. docs/probes.md

// Unit directions to uv in [0, 1].
fn irradia_octahedral_uv(direction: vec3f) -> vec2f {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    let signs = select(vec2f(-1.0), vec2f(1.0), p.xz >= vec2f(0.0));
    let folded = (1.0 - abs(p.zx)) * signs;
    return 0.5 * select(p.xz, folded, p.y < 0.0) + 0.5;
}

// The index of a texel (column, row) of a map of size x size; one step beyond an edge the octahedron goes on
// mirrored about the edge's middle.
fn irradia_octahedral_texel(place: vec2f, size: f32) -> u32 {
    let inside = clamp(place, vec2f(0.0), vec2f(size - 1.0));
    let mirrored = select(inside, size - 1.0 - inside, (place != inside).yx);
    return u32(mirrored.x + size * mirrored.y);
}
