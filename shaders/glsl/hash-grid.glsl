// Generated from shaders/wgsl/hash-grid.wgsl by `npm run shaders` in web/: don't edit.
// needs: value, numbers

uint irradia_table_corner(uvec3 corner, uint resolution, uint kind, uint n_entries, uvec3 primes) {
    if (kind == 0u) {
        uint entry = corner.x + (resolution * (corner.y + (resolution * corner.z)));
        return (entry >= n_entries) ? (entry - n_entries) : entry;
    }
    uvec3 hashed = corner * primes;
    uint hash = (hashed.x ^ hashed.y) ^ hashed.z;
    if (kind == 1u) {
        return hash & (n_entries - 1u);
    }
    return hash % n_entries;
}

uvec4 irradia_table_entry(uint first_texel, uint entry, uint part, uvec4 shape) {
    uint texel = (first_texel + ((entry >> shape.z) << shape.w)) + part;
    uint row = texel >> shape.x;
    uvec3 at = uvec3((texel & ((1u << shape.x) - 1u)), (row & ((1u << shape.y) - 1u)), (row >> shape.y));
    uint shift = (entry & ((1u << shape.z) - 1u)) * (32u >> shape.z);
    uvec4 _e37 = irradia_table_texel(at, shift);
    return _e37;
}

void irradia_table_hash_grid(uint record, vec3 unit) {
    uint column = 0u;
    uint at = 0u;
    vec4 _e2 = irradia_constant(record);
    uvec4 grid = uvec4(_e2);
    vec4 _e6 = irradia_constant((record + 1u));
    uvec4 shape = uvec4(_e6);
    vec4 _e10 = irradia_constant((record + 2u));
    uint _e12 = irradia_whole(_e10.xy);
    uint _e14 = irradia_whole(_e10.zw);
    vec4 _e17 = irradia_constant((record + 3u));
    uint _e19 = irradia_whole(_e17.xy);
    uvec3 primes = uvec3(_e12, _e14, _e19);
    uint n_parts = 1u << shape.w;
    column = grid.x;
    at = record + 4u;
    for (uint level = 0u; level < grid.y; level += 1u) {
        vec4 _e35 = irradia_constant(at);
        vec4 _e39 = irradia_constant((at + 1u));
        vec4 _e43 = irradia_constant((at + 2u));
        uvec2 scales = uvec2(_e43.xy);
        uint _e47 = irradia_whole(_e39.xy);
        uint _e49 = irradia_whole(_e39.zw);
        vec3 position = (_e35.x * unit) + vec3(_e35.y);
        vec3 cell = floor(position);
        vec3 fraction = position - cell;
        for (uint part = 0u; part < n_parts; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 8u; corner += 1u) {
                uvec3 far = uvec3((corner & 1u), ((corner >> 1u) & 1u), (corner >> 2u));
                vec3 side = mix((vec3(1.0) - fraction), fraction, equal(far, uvec3(1u)));
                uint _e91 = irradia_table_corner((uvec3(cell) + far), uint(_e35.z), uint(_e35.w), _e49, primes);
                float _e100 = irradia_table_scale(scales.x, (_e91 >> scales.y));
                float weight = ((side.x * side.y) * side.z) * _e100;
                uvec4 _e103 = irradia_table_entry(_e47, _e91, part, shape);
                irradia_table_add(_e103, weight);
            }
            irradia_table_push((column + (part * grid.w)), (grid.z - (part * grid.w)));
        }
        column = column + grid.z;
        at = at + 3u;
    }
}
