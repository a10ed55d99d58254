// Generated from shaders/wgsl/probe-cell-octree.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var irradia_probe_cells: texture_2d_array<u32>
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

uint irradia_probe_cell_word(uint index) {
    uvec2 shifts = uvec2(irradia_probe_layout[4].zw);
    uint x_1 = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y_1 = row & ((1u << shifts.y) - 1u);
    uvec4 _e27 = texelFetch(irradia_probe_cells, ivec3(ivec2(uvec2(x_1, y_1)), int((row >> shifts.y))), 0);
    return _e27.x;
}

vec4 irradia_probe_cell(vec3 position) {
    vec3 low = vec3(0.0);
    uint word = 0u;
    vec3 share = vec3(0.0);
    vec3 shape = irradia_probe_layout[2].xyz;
    vec3 at = (position - irradia_probe_layout[0].xyz) / irradia_probe_layout[1].xyz;
    low = clamp(floor(at), vec3(0.0), (shape - vec3(1.0)));
    uint _e36 = irradia_probe_cell_word(uint((low.x + (shape.x * (low.y + (shape.y * low.z))))));
    word = _e36;
    uint _e38 = word;
    if ((_e38 >> 30u) == 2u) {
        low = vec3(uvec3((word & 1023u), ((word >> 10u) & 1023u), ((word >> 20u) & 1023u)));
        uint _e71 = irradia_probe_cell_word(uint((low.x + (shape.x * (low.y + (shape.y * low.z))))));
        word = _e71;
    }
    share = clamp((at - low), vec3(0.0), vec3(1.0));
    for (uint level = 0u; level < 15u; level += 1u) {
        if ((word >> 30u) != 0u) {
            break;
        }
        uint first = word;
        low = min(floor((2.0 * share)), vec3(1.0));
        uint _e112 = irradia_probe_cell_word((first + uint(((low.x + (2.0 * low.y)) + (4.0 * low.z)))));
        word = _e112;
        uint _e113 = word;
        if ((_e113 >> 30u) == 2u) {
            uint child = word & 7u;
            low = vec3(uvec3((child & 1u), ((child >> 1u) & 1u), (child >> 2u)));
            uint _e132 = irradia_probe_cell_word((first + child));
            word = _e132;
        }
        share = clamp(((2.0 * share) - low), vec3(0.0), vec3(1.0));
    }
    return vec4(share, float((word & 1073741823u)));
}

uint irradia_probe_corner(float cell, uint corner) {
    float _e5 = irradia_probe_layout[0].w;
    uint _e12 = irradia_probe_cell_word(((uint(_e5) + (8u * uint(cell))) + corner));
    return _e12;
}
