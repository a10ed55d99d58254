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
    float3 fractions = (positions - cells);
    for (uint plane = 0u; plane < 3u; plane += 1u) {
        uint _e40 = plane;
        uint _e44 = plane;
        uint2 cell = naga_f2u32(((_e44 > 0u) ? ((_e40 == 2u) ? cells.yz : cells.xz) : cells.xy));
        uint _e52 = plane;
        uint _e56 = plane;
        float2 fraction = ((_e56 > 0u) ? ((_e52 == 2u) ? fractions.yz : fractions.xz) : fractions.xy);
        for (uint part = 0u; part < shape.w; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 4u; corner += 1u) {
                uint _e70 = corner;
                uint _e73 = corner;
                uint2 far = uint2((_e70 & 1u), (_e73 >> 1u));
                float2 side = ((far == (1u).xx) ? fraction : ((1.0).xx - fraction));
                uint2 at = (cell + far);
                uint _e85 = plane;
                const float _e93 = irradia_table_scale(scales[_e85], (((at.y * size) + at.x) >> scales.w));
                uint _e94 = plane;
                uint _e97 = part;
                const uint4 _e101 = irradia_table_texel(uint3(at, ((_e94 * shape.w) + _e97)), 0u);
                irradia_table_add(_e101, ((side.x * side.y) * _e93));
            }
            uint _e110 = plane;
            uint _e114 = part;
            uint _e119 = part;
            irradia_table_push(((shape.x + (_e110 * shape.y)) + (_e114 * shape.z)), (shape.y - (_e119 * shape.z)));
        }
    }
    return;
}
