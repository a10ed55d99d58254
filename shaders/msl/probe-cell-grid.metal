// Generated from shaders/wgsl/probe-cell-grid.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

metal::float4 irradia_probe_cell(
    metal::float3 position
) {
    metal::float3 shape = irradia_probe_layout[2].xyz;
    metal::float3 along = (position - irradia_probe_layout[0].xyz) / irradia_probe_layout[1].xyz;
    metal::float3 at = metal::clamp(along, metal::float3(0.0), shape - metal::float3(1.0));
    metal::float3 low = metal::min(metal::floor(at), metal::max(shape - metal::float3(2.0), metal::float3(0.0)));
    return metal::float4(at - low, low.x + (shape.x * (low.y + (shape.y * low.z))));
}

uint irradia_probe_corner(
    float cell,
    uint corner
) {
    metal::uint3 shape = naga_f2u32(irradia_probe_layout[2].xyz);
    metal::uint3 bits = metal::min(metal::uint3(corner & 1u, (corner >> 1u) & 1u, corner >> 2u), shape - metal::uint3(1u));
    return (naga_f2u32(cell) + bits.x) + (shape.x * (bits.y + (shape.y * bits.z)));
}
