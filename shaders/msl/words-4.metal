// Generated from shaders/wgsl/words-4.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: var irradia_table: texture_2d_array<u32>

static constant constexpr const uint irradia_table_words = 4u;

metal::uint4 irradia_table_texel(
    metal::uint3 at,
    uint shift
) {
    metal::uint4 _e6 = irradia_table.read(metal::uint2(at.xy), at.z, 0);
    return _e6;
}
