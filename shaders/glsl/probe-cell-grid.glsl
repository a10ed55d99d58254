// Generated from shaders/wgsl/probe-cell-grid.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

vec4 irradia_probe_cell(vec3 position) {
    vec3 shape = irradia_probe_layout[2].xyz;
    vec3 along = (position - irradia_probe_layout[0].xyz) / irradia_probe_layout[1].xyz;
    vec3 at = clamp(along, vec3(0.0), (shape - vec3(1.0)));
    vec3 low = min(floor(at), max((shape - vec3(2.0)), vec3(0.0)));
    return vec4((at - low), (low.x + (shape.x * (low.y + (shape.y * low.z)))));
}

uint irradia_probe_corner(float cell, uint corner) {
    uvec3 shape = uvec3(irradia_probe_layout[2].xyz);
    uvec3 bits = min(uvec3((corner & 1u), ((corner >> 1u) & 1u), (corner >> 2u)), (shape - uvec3(1u)));
    return (uint(cell) + bits.x) + (shape.x * (bits.y + (shape.y * bits.z)));
}
