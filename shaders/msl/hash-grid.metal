// Generated from shaders/wgsl/hash-grid.wgsl by `npm run shaders` in web/: don't edit.
// needs: value, numbers

uint irradia_table_corner(
    metal::uint3 corner,
    uint resolution,
    uint kind,
    uint n_entries,
    metal::uint3 primes
) {
    if (kind == 0u) {
        uint entry = corner.x + (resolution * (corner.y + (resolution * corner.z)));
        return (entry >= n_entries) ? (entry - n_entries) : entry;
    }
    metal::uint3 hashed = corner * primes;
    uint hash = (hashed.x ^ hashed.y) ^ hashed.z;
    if (kind == 1u) {
        return hash & (n_entries - 1u);
    }
    return naga_mod(hash, n_entries);
}

metal::uint4 irradia_table_entry(
    uint first_texel,
    uint entry,
    uint part,
    metal::uint4 shape
) {
    uint texel = (first_texel + ((entry >> shape.z) << shape.w)) + part;
    uint row = texel >> shape.x;
    metal::uint3 at = metal::uint3(texel & ((1u << shape.x) - 1u), row & ((1u << shape.y) - 1u), row >> shape.y);
    uint shift = (entry & ((1u << shape.z) - 1u)) * (32u >> shape.z);
    metal::uint4 _e37 = irradia_table_texel(at, shift);
    return _e37;
}

void irradia_table_hash_grid(
    uint record,
    metal::float3 unit
) {
    uint column = {};
    uint at = {};
    metal::float4 _e2 = irradia_constant(record);
    metal::uint4 grid = naga_f2u32(_e2);
    metal::float4 _e6 = irradia_constant(record + 1u);
    metal::uint4 shape = naga_f2u32(_e6);
    metal::float4 _e10 = irradia_constant(record + 2u);
    uint _e12 = irradia_whole(_e10.xy);
    uint _e14 = irradia_whole(_e10.zw);
    metal::float4 _e17 = irradia_constant(record + 3u);
    uint _e19 = irradia_whole(_e17.xy);
    metal::uint3 primes = metal::uint3(_e12, _e14, _e19);
    uint n_parts = 1u << shape.w;
    column = grid.x;
    at = record + 4u;
    for (uint level = 0u; level < grid.y; level += 1u) {
        metal::float4 _e35 = irradia_constant(at);
        metal::float4 _e39 = irradia_constant(at + 1u);
        metal::float4 _e43 = irradia_constant(at + 2u);
        metal::uint2 scales = naga_f2u32(_e43.xy);
        uint _e47 = irradia_whole(_e39.xy);
        uint _e49 = irradia_whole(_e39.zw);
        metal::float3 position = (_e35.x * unit) + metal::float3(_e35.y);
        metal::float3 cell = metal::floor(position);
        metal::float3 fraction = position - cell;
        for (uint part = 0u; part < n_parts; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 8u; corner += 1u) {
                metal::uint3 far = metal::uint3(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
                metal::float3 side = metal::select(metal::float3(1.0) - fraction, fraction, far == metal::uint3(1u));
                uint _e91 = irradia_table_corner(naga_f2u32(cell) + far, naga_f2u32(_e35.z), naga_f2u32(_e35.w), _e49, primes);
                float _e100 = irradia_table_scale(scales.x, _e91 >> scales.y);
                float weight = ((side.x * side.y) * side.z) * _e100;
                metal::uint4 _e103 = irradia_table_entry(_e47, _e91, part, shape);
                irradia_table_add(_e103, weight);
            }
            irradia_table_push(column + (part * grid.w), grid.z - (part * grid.w));
        }
        column = column + grid.z;
        at = at + 3u;
    }
}
