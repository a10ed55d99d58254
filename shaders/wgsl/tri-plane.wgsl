// Bilinear lookups in three learned images along the box's axes. Its record among the constants:
//     0  first feature's column, features of an entry, features of a texel, texels of an entry
//     1  scale and offset: a point lies at scale · x + offset, where texel centres are whole; texels of a side
//     2  first scale of each plane, binary logarithm of the entries that share one
// needs: value

// Pushes the features of the planes xy, xz and yz at a point of [0, 1]³.
fn irradia_table_tri_plane(record: u32, unit: vec3f) {
    let shape = vec4u(irradia_constant(record));
    let texels = irradia_constant(record + 1u);
    let scales = vec4u(irradia_constant(record + 2u));
    let size = u32(texels.z);
    let positions = clamp(texels.x * unit + texels.y, vec3f(0.0), vec3f(texels.z - 1.0));
    // The last texel is the end of the last cell.
    let cells = min(floor(positions), vec3f(texels.z - 2.0));
    let fractions = positions - cells;
    for (var plane = 0u; plane < 3u; plane++) {
        let cell = vec2u(select(cells.xy, select(cells.xz, cells.yz, plane == 2u), plane > 0u));
        let fraction = select(fractions.xy, select(fractions.xz, fractions.yz, plane == 2u), plane > 0u);
        for (var part = 0u; part < shape.w; part++) {
            irradia_table_clear();
            for (var corner = 0u; corner < 4u; corner++) {
                let far = vec2u(corner & 1u, corner >> 1u);
                let side = select(1.0 - fraction, fraction, far == vec2u(1u));
                let at = cell + far;
                let scale = irradia_table_scale(scales[plane], (at.y * size + at.x) >> scales.w);
                irradia_table_add(
                    irradia_table_texel(vec3u(at, plane * shape.w + part), 0u),
                    side.x * side.y * scale,
                );
            }
            irradia_table_push(shape.x + plane * shape.y + part * shape.z, shape.y - part * shape.z);
        }
    }
}
