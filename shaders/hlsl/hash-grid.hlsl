// Generated from shaders/wgsl/hash-grid.wgsl by `npm run shaders` in web/: don't edit.
// needs: value, numbers

uint irradia_table_corner(uint3 corner, uint resolution, uint kind, uint n_entries, uint3 primes)
{
    if (kind == 0u) {
        uint entry = corner.x + (resolution * (corner.y + (resolution * corner.z)));
        return (entry >= n_entries) ? (entry - n_entries) : entry;
    }
    uint3 hashed = corner * primes;
    uint hash = (hashed.x ^ hashed.y) ^ hashed.z;
    if (kind == 1u) {
        return hash & (n_entries - 1u);
    }
    return naga_mod(hash, n_entries);
}

uint4 irradia_table_entry(uint first_texel, uint entry, uint part, uint4 shape)
{
    uint texel = (first_texel + ((entry >> shape.z) << shape.w)) + part;
    uint row = texel >> shape.x;
    uint3 at = uint3((texel & ((1u << shape.x) - 1u)), (row & ((1u << shape.y) - 1u)), (row >> shape.y));
    uint shift = (entry & ((1u << shape.z) - 1u)) * (32u >> shape.z);
    const uint4 _e37 = irradia_table_texel(at, shift);
    return _e37;
}

void irradia_table_hash_grid(uint record, float3 unit)
{
    uint column = (uint)0;
    uint at = (uint)0;

    const float4 _e2 = irradia_constant(record);
    uint4 grid = naga_f2u32(_e2);
    const float4 _e6 = irradia_constant((record + 1u));
    uint4 shape = naga_f2u32(_e6);
    const float4 _e10 = irradia_constant((record + 2u));
    const uint _e12 = irradia_whole(_e10.xy);
    const uint _e14 = irradia_whole(_e10.zw);
    const float4 _e17 = irradia_constant((record + 3u));
    const uint _e19 = irradia_whole(_e17.xy);
    uint3 primes = uint3(_e12, _e14, _e19);
    uint n_parts = 1u << shape.w;
    column = grid.x;
    at = record + 4u;
    for (uint level = 0u; level < grid.y; level += 1u) {
        const float4 _e35 = irradia_constant(at);
        const float4 _e39 = irradia_constant((at + 1u));
        const float4 _e43 = irradia_constant((at + 2u));
        uint2 scales = naga_f2u32(_e43.xy);
        const uint _e47 = irradia_whole(_e39.xy);
        const uint _e49 = irradia_whole(_e39.zw);
        float3 position = (_e35.x * unit) + (_e35.y).xxx;
        float3 cell = floor(position);
        float3 fraction = position - cell;
        for (uint part = 0u; part < n_parts; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 8u; corner += 1u) {
                uint3 far = uint3((corner & 1u), ((corner >> 1u) & 1u), (corner >> 2u));
                float3 side = (far == (1u).xxx) ? fraction : ((1.0).xxx - fraction);
                const uint _e91 = irradia_table_corner((naga_f2u32(cell) + far), naga_f2u32(_e35.z), naga_f2u32(_e35.w), _e49, primes);
                const float _e100 = irradia_table_scale(scales.x, (_e91 >> scales.y));
                float weight = ((side.x * side.y) * side.z) * _e100;
                const uint4 _e103 = irradia_table_entry(_e47, _e91, part, shape);
                irradia_table_add(_e103, weight);
            }
            irradia_table_push((column + (part * grid.w)), (grid.z - (part * grid.w)));
        }
        column = column + grid.z;
        at = at + 3u;
    }
}
