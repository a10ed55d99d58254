// Generated from shaders/wgsl/probe-cell-octree.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var irradia_probe_cells: texture_2d_array<u32>
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

uint irradia_probe_cell_word(
    uint index
) {
    metal::uint2 shifts = naga_f2u32(irradia_probe_layout[4].zw);
    uint x_1 = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y_1 = row & ((1u << shifts.y) - 1u);
    metal::uint4 _e27 = irradia_probe_cells.read(metal::uint2(static_cast<metal::int2>(metal::uint2(x_1, y_1))), static_cast<int>(row >> shifts.y), 0);
    return _e27.x;
}

metal::float4 irradia_probe_cell(
    metal::float3 position
) {
    metal::float3 low = {};
    uint word = {};
    metal::float3 share = {};
    metal::float3 shape = irradia_probe_layout[2].xyz;
    metal::float3 at = (position - irradia_probe_layout[0].xyz) / irradia_probe_layout[1].xyz;
    low = metal::clamp(metal::floor(at), metal::float3(0.0), shape - metal::float3(1.0));
    uint _e36 = irradia_probe_cell_word(naga_f2u32(low.x + (shape.x * (low.y + (shape.y * low.z)))));
    word = _e36;
    uint _e38 = word;
    if ((_e38 >> 30u) == 2u) {
        low = static_cast<metal::float3>(metal::uint3(word & 1023u, (word >> 10u) & 1023u, (word >> 20u) & 1023u));
        uint _e71 = irradia_probe_cell_word(naga_f2u32(low.x + (shape.x * (low.y + (shape.y * low.z)))));
        word = _e71;
    }
    share = metal::clamp(at - low, metal::float3(0.0), metal::float3(1.0));
    for (uint level = 0u; level < 15u; level += 1u) {
        if ((word >> 30u) != 0u) {
            break;
        }
        uint first = word;
        low = metal::min(metal::floor(2.0 * share), metal::float3(1.0));
        uint _e112 = irradia_probe_cell_word(first + naga_f2u32((low.x + (2.0 * low.y)) + (4.0 * low.z)));
        word = _e112;
        uint _e113 = word;
        if ((_e113 >> 30u) == 2u) {
            uint child = word & 7u;
            low = static_cast<metal::float3>(metal::uint3(child & 1u, (child >> 1u) & 1u, child >> 2u));
            uint _e132 = irradia_probe_cell_word(first + child);
            word = _e132;
        }
        share = metal::clamp((2.0 * share) - low, metal::float3(0.0), metal::float3(1.0));
    }
    return metal::float4(share, static_cast<float>(word & 1073741823u));
}

uint irradia_probe_corner(
    float cell,
    uint corner
) {
    float _e5 = irradia_probe_layout[0].w;
    uint _e12 = irradia_probe_cell_word((naga_f2u32(_e5) + (8u * naga_f2u32(cell))) + corner);
    return _e12;
}
