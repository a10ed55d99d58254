// Generated from shaders/wgsl/probe-cell-grid.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

float4 irradia_probe_cell(float3 position)
{
    float4 _e3 = irradia_probe_layout[2];
    float3 shape = _e3.xyz;
    float4 _e7 = irradia_probe_layout[0];
    float4 _e12 = irradia_probe_layout[1];
    float3 along = ((position - _e7.xyz) / _e12.xyz);
    float3 at = clamp(along, (0.0).xxx, (shape - (1.0).xxx));
    float3 low = min(floor(at), max((shape - (2.0).xxx), (0.0).xxx));
    return float4((at - low), (low.x + (shape.x * (low.y + (shape.y * low.z)))));
}

uint irradia_probe_corner(float cell, uint corner)
{
    float4 _e4 = irradia_probe_layout[2];
    uint3 shape = naga_f2u32(_e4.xyz);
    uint3 bits = min(uint3((corner & 1u), ((corner >> 1u) & 1u), (corner >> 2u)), (shape - (1u).xxx));
    return ((naga_f2u32(cell) + bits.x) + (shape.x * (bits.y + (shape.y * bits.z))));
}
