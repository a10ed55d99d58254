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
        metal::uint2 cell = naga_f2u32((plane > 0u) ? ((plane == 2u) ? cells.yz : cells.xz) : cells.xy);
        metal::float2 fraction = (plane > 0u) ? ((plane == 2u) ? fractions.yz : fractions.xz) : fractions.xy;
        for (uint part = 0u; part < shape.w; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 4u; corner += 1u) {
                metal::uint2 far = metal::uint2(corner & 1u, corner >> 1u);
                metal::float2 side = metal::select(metal::float2(1.0) - fraction, fraction, far == metal::uint2(1u));
                metal::uint2 at = cell + far;
                float _e93 = irradia_table_scale(scales[plane], ((at.y * size) + at.x) >> scales.w);
                metal::uint4 _e101 = irradia_table_texel(metal::uint3(at, (plane * shape.w) + part), 0u);
                irradia_table_add(_e101, (side.x * side.y) * _e93);
            }
            irradia_table_push((shape.x + (plane * shape.y)) + (part * shape.z), shape.y - (part * shape.z));
        }
    }
}
