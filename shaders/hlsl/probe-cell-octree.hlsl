// Generated from shaders/wgsl/probe-cell-octree.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var irradia_probe_cells: texture_2d_array<u32>
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

uint irradia_probe_cell_word(uint index)
{
    uint2 shifts = naga_f2u32(irradia_probe_layout[4].zw);
    uint x_1 = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y_1 = row & ((1u << shifts.y) - 1u);
    uint4 _e27 = irradia_probe_cells.Load(int4(int2(uint2(x_1, y_1)), int((row >> shifts.y)), int(0)));
    return _e27.x;
}

float4 irradia_probe_cell(float3 position)
{
    float3 low = (float3)0;
    uint word = (uint)0;
    float3 share = (float3)0;

    float3 shape = irradia_probe_layout[2].xyz;
    float3 at = (position - irradia_probe_layout[0].xyz) / irradia_probe_layout[1].xyz;
    low = clamp(floor(at), (0.0).xxx, (shape - (1.0).xxx));
    const uint _e36 = irradia_probe_cell_word(naga_f2u32((low.x + (shape.x * (low.y + (shape.y * low.z))))));
    word = _e36;
    uint _e38 = word;
    if ((_e38 >> 30u) == 2u) {
        low = float3(uint3((word & 1023u), ((word >> 10u) & 1023u), ((word >> 20u) & 1023u)));
        const uint _e71 = irradia_probe_cell_word(naga_f2u32((low.x + (shape.x * (low.y + (shape.y * low.z))))));
        word = _e71;
    }
    share = clamp((at - low), (0.0).xxx, (1.0).xxx);
    for (uint level = 0u; level < 15u; level += 1u) {
        if ((word >> 30u) != 0u) {
            break;
        }
        uint first = word;
        low = min(floor((2.0 * share)), (1.0).xxx);
        const uint _e112 = irradia_probe_cell_word((first + naga_f2u32(((low.x + (2.0 * low.y)) + (4.0 * low.z)))));
        word = _e112;
        uint _e113 = word;
        if ((_e113 >> 30u) == 2u) {
            uint child = word & 7u;
            low = float3(uint3((child & 1u), ((child >> 1u) & 1u), (child >> 2u)));
            const uint _e132 = irradia_probe_cell_word((first + child));
            word = _e132;
        }
        share = clamp(((2.0 * share) - low), (0.0).xxx, (1.0).xxx);
    }
    return float4(share, float((word & 1073741823u)));
}

uint irradia_probe_corner(float cell, uint corner)
{
    float _e5 = irradia_probe_layout[0].w;
    const uint _e12 = irradia_probe_cell_word(((naga_f2u32(_e5) + (8u * naga_f2u32(cell))) + corner));
    return _e12;
}
