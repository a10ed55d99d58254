// Generated from shaders/wgsl/tri-plane.wgsl by `npm run shaders` in web/: don't edit.
// needs: value

void irradia_table_tri_plane(uint record, float3 unit)
{
    const float4 _e2 = irradia_constant(record);
    uint4 shape = naga_f2u32(_e2);
    const float4 _e6 = irradia_constant((record + 1u));
    const float4 _e9 = irradia_constant((record + 2u));
    uint4 scales = naga_f2u32(_e9);
    uint size = naga_f2u32(_e6.z);
    float3 positions = clamp(((_e6.x * unit) + (_e6.y).xxx), (0.0).xxx, ((_e6.z - 1.0)).xxx);
    float3 cells = min(floor(positions), ((_e6.z - 2.0)).xxx);
    float3 fractions = positions - cells;
    for (uint plane = 0u; plane < 3u; plane += 1u) {
        uint2 cell = naga_f2u32(((plane > 0u) ? ((plane == 2u) ? cells.yz : cells.xz) : cells.xy));
        float2 fraction = (plane > 0u) ? ((plane == 2u) ? fractions.yz : fractions.xz) : fractions.xy;
        for (uint part = 0u; part < shape.w; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 4u; corner += 1u) {
                uint2 far = uint2((corner & 1u), (corner >> 1u));
                float2 side = (far == (1u).xx) ? fraction : ((1.0).xx - fraction);
                uint2 at = cell + far;
                const float _e93 = irradia_table_scale(scales[plane], (((at.y * size) + at.x) >> scales.w));
                const uint4 _e101 = irradia_table_texel(uint3(at, ((plane * shape.w) + part)), 0u);
                irradia_table_add(_e101, ((side.x * side.y) * _e93));
            }
            irradia_table_push(((shape.x + (plane * shape.y)) + (part * shape.z)), (shape.y - (part * shape.z)));
        }
    }
}
