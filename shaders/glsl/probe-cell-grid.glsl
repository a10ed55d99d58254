// Generated from shaders/wgsl/probe-cell-grid.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

vec4 irradia_probe_cell(vec3 position) {
    vec4 _e3 = irradia_probe_layout[2];
    vec3 shape = _e3.xyz;
    vec4 _e7 = irradia_probe_layout[0];
    vec4 _e12 = irradia_probe_layout[1];
    vec3 along = ((position - _e7.xyz) / _e12.xyz);
    vec3 at = clamp(along, vec3(0.0), (shape - vec3(1.0)));
    vec3 low = min(floor(at), max((shape - vec3(2.0)), vec3(0.0)));
    return vec4((at - low), (low.x + (shape.x * (low.y + (shape.y * low.z)))));
}

uint irradia_probe_corner(float cell, uint corner) {
    vec4 _e4 = irradia_probe_layout[2];
    uvec3 shape = uvec3(_e4.xyz);
    uvec3 bits = min(uvec3((corner & 1u), ((corner >> 1u) & 1u), (corner >> 2u)), (shape - uvec3(1u)));
    return ((uint(cell) + bits.x) + (shape.x * (bits.y + (shape.y * bits.z))));
}
