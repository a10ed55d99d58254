// Which probes of a regular grid lie around a place: the eight corners of its cell.
// needs: probes
// given: var<uniform> irradia_probe_layout: array<vec4f>

// A place's cell: how far along each axis the place is in it, in [0, 1], and the probe at its lowest corner.
fn irradia_probe_cell(position: vec3f) -> vec4f {
    let shape = irradia_probe_layout[2].xyz;
    let along = (position - irradia_probe_layout[0].xyz) / irradia_probe_layout[1].xyz;
    let at = clamp(along, vec3f(0.0), shape - 1.0);
    let low = min(floor(at), max(shape - 2.0, vec3f(0.0)));
    return vec4f(at - low, low.x + shape.x * (low.y + shape.y * low.z));
}

// The probe at a corner of a cell; bit 0 of the corner's number is +x, bit 1 +y, bit 2 +z.
fn irradia_probe_corner(cell: f32, corner: u32) -> u32 {
    let shape = vec3u(irradia_probe_layout[2].xyz);
    // An axis with a single probe has that at both ends.
    let bits = min(vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u), shape - 1u);
    return u32(cell) + bits.x + shape.x * (bits.y + shape.y * bits.z);
}
