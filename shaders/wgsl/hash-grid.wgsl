// Multi-resolution hash grid (Müller et al. 2022, section 3). Its record among the constants:
//     0  first feature's column, levels, features of an entry, features of a texel
//     1  binary logarithms of: texels of a row, rows of a layer, entries of a texel, texels of an entry
//     2  factors of x and y in the hash, by 16 bits        3  factor of z
// and for each level
//     0  scale and offset: a point lies at scale · x + offset; corners along an axis; 0 where they are numbered, x
//        fastest, 1 hashed into 2ⁿ entries, 2 into any number
//     1  first texel and number of entries, by 16 bits
//     2  first scale, binary logarithm of the entries that share one
// needs: value, numbers

// The entry at a corner of a cell.
fn irradia_table_corner(corner: vec3u, resolution: u32, kind: u32, n_entries: u32, primes: vec3u) -> u32 {
    if (kind == 0u) {
        // At x = 1 a corner may lie one beyond; numbers run on into the next row, and wrap once at the table's end.
        let entry = corner.x + resolution * (corner.y + resolution * corner.z);
        return select(entry, entry - n_entries, entry >= n_entries);
    }
    let hashed = corner * primes;
    let hash = hashed.x ^ hashed.y ^ hashed.z;
    if (kind == 1u) {
        return hash & (n_entries - 1u);
    }
    return hash % n_entries;
}

// Words of a part of an entry; an entry of more than four words has several texels, side by side.
fn irradia_table_entry(first_texel: u32, entry: u32, part: u32, shape: vec4u) -> vec4u {
    let texel = first_texel + ((entry >> shape.z) << shape.w) + part;
    let row = texel >> shape.x;
    let at = vec3u(texel & ((1u << shape.x) - 1u), row & ((1u << shape.y) - 1u), row >> shape.y);
    let shift = (entry & ((1u << shape.z) - 1u)) * (32u >> shape.z);
    return irradia_table_texel(at, shift);
}

// Pushes the features of all levels at a point of [0, 1]³, the coarsest first.
fn irradia_table_hash_grid(record: u32, unit: vec3f) {
    let grid = vec4u(irradia_constant(record));
    let shape = vec4u(irradia_constant(record + 1u));
    let xy = irradia_constant(record + 2u);
    let primes = vec3u(irradia_whole(xy.xy), irradia_whole(xy.zw), irradia_whole(irradia_constant(record + 3u).xy));
    let n_parts = 1u << shape.w;
    var column = grid.x;
    var at = record + 4u;
    for (var level = 0u; level < grid.y; level++) {
        let cells = irradia_constant(at);
        let place = irradia_constant(at + 1u);
        let scales = vec2u(irradia_constant(at + 2u).xy);
        let first_texel = irradia_whole(place.xy);
        let n_entries = irradia_whole(place.zw);
        let position = cells.x * unit + cells.y;
        let cell = floor(position);
        let fraction = position - cell;
        for (var part = 0u; part < n_parts; part++) {
            irradia_table_clear();
            for (var corner = 0u; corner < 8u; corner++) {
                let far = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
                let side = select(1.0 - fraction, fraction, far == vec3u(1u));
                let entry = irradia_table_corner(vec3u(cell) + far, u32(cells.z), u32(cells.w), n_entries, primes);
                let weight = side.x * side.y * side.z * irradia_table_scale(scales.x, entry >> scales.y);
                irradia_table_add(irradia_table_entry(first_texel, entry, part, shape), weight);
            }
            irradia_table_push(column + part * grid.w, grid.z - part * grid.w);
        }
        column += grid.z;
        at += 3u;
    }
}
