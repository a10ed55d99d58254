// Generated from shaders/wgsl/probe-cell-octree.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var irradia_probe_cells: texture_2d_array<u32>
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

uint irradia_probe_cell_word(uint index) {
    vec4 _e3 = irradia_probe_layout[4];
    uvec2 shifts = uvec2(_e3.zw);
    uint x_1 = (index & ((1u << shifts.x) - 1u));
    uint row = (index >> shifts.x);
    uint y_1 = (row & ((1u << shifts.y) - 1u));
    uvec4 _e27 = texelFetch(irradia_probe_cells, ivec3(ivec2(uvec2(x_1, y_1)), int((row >> shifts.y))), 0);
    return _e27.x;
}

vec4 irradia_probe_cell(vec3 position) {
    vec3 low = vec3(0.0);
    uint word = 0u;
    vec3 share = vec3(0.0);
    vec4 _e3 = irradia_probe_layout[2];
    vec3 shape = _e3.xyz;
    vec4 _e7 = irradia_probe_layout[0];
    vec4 _e12 = irradia_probe_layout[1];
    vec3 at = ((position - _e7.xyz) / _e12.xyz);
    low = clamp(floor(at), vec3(0.0), (shape - vec3(1.0)));
    float _e24 = low.x;
    float _e27 = low.y;
    float _e30 = low.z;
    uint _e36 = irradia_probe_cell_word(uint((_e24 + (shape.x * (_e27 + (shape.y * _e30))))));
    word = _e36;
    uint _e38 = word;
    if (((_e38 >> 30u) == 2u)) {
        uint _e43 = word;
        uint _e46 = word;
        uint _e51 = word;
        low = vec3(uvec3((_e43 & 1023u), ((_e46 >> 10u) & 1023u), ((_e51 >> 20u) & 1023u)));
        float _e59 = low.x;
        float _e62 = low.y;
        float _e65 = low.z;
        uint _e71 = irradia_probe_cell_word(uint((_e59 + (shape.x * (_e62 + (shape.y * _e65))))));
        word = _e71;
    }
    vec3 _e72 = low;
    share = clamp((at - _e72), vec3(0.0), vec3(1.0));
    for (uint level = 0u; level < 15u; level += 1u) {
        uint _e85 = word;
        if (((_e85 >> 30u) != 0u)) {
            break;
        }
        uint first = word;
        vec3 _e91 = share;
        low = min(floor((2.0 * _e91)), vec3(1.0));
        float _e99 = low.x;
        float _e101 = low.y;
        float _e106 = low.z;
        uint _e112 = irradia_probe_cell_word((first + uint(((_e99 + (2.0 * _e101)) + (4.0 * _e106)))));
        word = _e112;
        uint _e113 = word;
        if (((_e113 >> 30u) == 2u)) {
            uint _e118 = word;
            uint child = (_e118 & 7u);
            low = vec3(uvec3((child & 1u), ((child >> 1u) & 1u), (child >> 2u)));
            uint _e132 = irradia_probe_cell_word((first + child));
            word = _e132;
        }
        vec3 _e133 = share;
        vec3 _e136 = low;
        share = clamp(((2.0 * _e133) - _e136), vec3(0.0), vec3(1.0));
    }
    vec3 _e146 = share;
    uint _e147 = word;
    return vec4(_e146, float((_e147 & 1073741823u)));
}

uint irradia_probe_corner(float cell, uint corner) {
    float _e5 = irradia_probe_layout[0].w;
    uint _e12 = irradia_probe_cell_word(((uint(_e5) + (8u * uint(cell))) + corner));
    return _e12;
}
