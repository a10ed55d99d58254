// Generated from shaders/wgsl/octahedral.wgsl by `npm run shaders` in web/: don't edit.

vec2 irradia_octahedral_uv(vec3 direction) {
    vec3 p = direction / vec3(((abs(direction.x) + abs(direction.y)) + abs(direction.z)));
    vec2 signs = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p.xz, vec2(0.0)));
    vec2 folded = (vec2(1.0) - abs(p.zx)) * signs;
    return (0.5 * ((p.y < 0.0) ? folded : p.xz)) + vec2(0.5);
}

uint irradia_octahedral_texel(vec2 place, float size) {
    vec2 inside = clamp(place, vec2(0.0), vec2((size - 1.0)));
    vec2 mirrored = mix(inside, (vec2((size - 1.0)) - inside), notEqual(place, inside).yx);
    return uint((mirrored.x + (size * mirrored.y)));
}
