// Generated from shaders/wgsl/numbers.wgsl by `npm run shaders` in web/: don't edit.

uint irradia_whole(float2 parts)
{
    return naga_f2u32(parts.x) | (naga_f2u32(parts.y) << 16u);
}
