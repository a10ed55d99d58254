// Generated from shaders/wgsl/octahedral.wgsl by `npm run shaders` in web/: don't edit.

float2 irradia_octahedral_uv(float3 direction)
{
    float3 p = direction / (((abs(direction.x) + abs(direction.y)) + abs(direction.z))).xxx;
    float2 signs = (p.xz >= (0.0).xx) ? (1.0).xx : (-1.0).xx;
    float2 folded = ((1.0).xx - abs(p.zx)) * signs;
    return (0.5 * ((p.y < 0.0) ? folded : p.xz)) + (0.5).xx;
}

uint irradia_octahedral_texel(float2 place, float size)
{
    float2 inside = clamp(place, (0.0).xx, ((size - 1.0)).xx);
    float2 mirrored = (place != inside).yx ? (((size - 1.0)).xx - inside) : inside;
    return naga_f2u32((mirrored.x + (size * mirrored.y)));
}
