// Generated from shaders/wgsl/words-1.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: var irradia_table: texture_2d_array<u32>

static const uint irradia_table_words = 1u;

uint4 irradia_table_texel(uint3 at, uint shift)
{
    uint4 _e6 = irradia_table.Load(int4(at.xy, at.z, int(0)));
    return ((_e6.x >> shift)).xxxx;
}
