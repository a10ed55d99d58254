// Generated from shaders/wgsl/words-2.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: var irradia_table: texture_2d_array<u32>

const uint irradia_table_words = 2u;

uvec4 irradia_table_texel(uvec3 at, uint shift) {
    uvec4 _e6 = texelFetch(irradia_table, ivec3(at.xy, at.z), 0);
    return _e6;
}
