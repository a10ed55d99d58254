// Generated from shaders/wgsl/tri-plane.wgsl by `npm run shaders` in web/: don't edit.
// needs: value

void irradia_table_tri_plane(
    uint record,
    metal::float3 unit
) {
    metal::float4 _e2 = irradia_constant(record);
    metal::uint4 shape = naga_f2u32(_e2);
    metal::float4 _e6 = irradia_constant(record + 1u);
    metal::float4 _e9 = irradia_constant(record + 2u);
    metal::uint4 scales = naga_f2u32(_e9);
    uint size = naga_f2u32(_e6.z);
    metal::float3 positions = metal::clamp((_e6.x * unit) + metal::float3(_e6.y), metal::float3(0.0), metal::float3(_e6.z - 1.0));
    metal::float3 cells = metal::min(metal::floor(positions), metal::float3(_e6.z - 2.0));
    metal::float3 fractions = positions - cells;
    for (uint plane = 0u; plane < 3u; plane += 1u) {
        uint _e40 = plane;
        uint _e44 = plane;
        metal::uint2 cell = naga_f2u32((_e44 > 0u) ? ((_e40 == 2u) ? cells.yz : cells.xz) : cells.xy);
        uint _e52 = plane;
        uint _e56 = plane;
        metal::float2 fraction = (_e56 > 0u) ? ((_e52 == 2u) ? fractions.yz : fractions.xz) : fractions.xy;
        for (uint part = 0u; part < shape.w; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 4u; corner += 1u) {
                uint _e70 = corner;
                uint _e73 = corner;
                metal::uint2 far = metal::uint2(_e70 & 1u, _e73 >> 1u);
                metal::float2 side = metal::select(metal::float2(1.0) - fraction, fraction, far == metal::uint2(1u));
                metal::uint2 at = cell + far;
                uint _e85 = plane;
                float _e93 = irradia_table_scale(scales[_e85], ((at.y * size) + at.x) >> scales.w);
                uint _e94 = plane;
                uint _e97 = part;
                metal::uint4 _e101 = irradia_table_texel(metal::uint3(at, (_e94 * shape.w) + _e97), 0u);
                irradia_table_add(_e101, (side.x * side.y) * _e93);
            }
            uint _e110 = plane;
            uint _e114 = part;
            uint _e119 = part;
            irradia_table_push((shape.x + (_e110 * shape.y)) + (_e114 * shape.z), shape.y - (_e119 * shape.z));
        }
    }
    return;
}
