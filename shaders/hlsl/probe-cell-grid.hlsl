// Generated from shaders/wgsl/probe-cell-grid.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

float4 irradia_probe_cell(float3 position)
{
    float3 shape = irradia_probe_layout[2].xyz;
    float3 along = (position - irradia_probe_layout[0].xyz) / irradia_probe_layout[1].xyz;
    float3 at = clamp(along, (0.0).xxx, (shape - (1.0).xxx));
    float3 low = min(floor(at), max((shape - (2.0).xxx), (0.0).xxx));
    return float4((at - low), (low.x + (shape.x * (low.y + (shape.y * low.z)))));
}

uint irradia_probe_corner(float cell, uint corner)
{
    uint3 shape = naga_f2u32(irradia_probe_layout[2].xyz);
    uint3 bits = min(uint3((corner & 1u), ((corner >> 1u) & 1u), (corner >> 2u)), (shape - (1u).xxx));
    return (naga_f2u32(cell) + bits.x) + (shape.x * (bits.y + (shape.y * bits.z)));
}
