// Generated from shaders/wgsl/numbers.wgsl by `npm run shaders` in web/: don't edit.

uint irradia_whole(vec2 parts) {
    return uint(parts.x) | (uint(parts.y) << 16u);
}
