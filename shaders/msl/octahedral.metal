// Generated from shaders/wgsl/octahedral.wgsl by `npm run shaders` in web/: don't edit.

metal::float2 irradia_octahedral_uv(
    metal::float3 direction
) {
    metal::float3 p = direction / metal::float3((metal::abs(direction.x) + metal::abs(direction.y)) + metal::abs(direction.z));
    metal::float2 signs = metal::select(metal::float2(-1.0), metal::float2(1.0), p.xz >= metal::float2(0.0));
    metal::float2 folded = (metal::float2(1.0) - metal::abs(p.zx)) * signs;
    return (0.5 * ((p.y < 0.0) ? folded : p.xz)) + metal::float2(0.5);
}

uint irradia_octahedral_texel(
    metal::float2 place,
    float size
) {
    metal::float2 inside = metal::clamp(place, metal::float2(0.0), metal::float2(size - 1.0));
    metal::float2 mirrored = metal::select(inside, metal::float2(size - 1.0) - inside, (place != inside).yx);
    return naga_f2u32(mirrored.x + (size * mirrored.y));
}
