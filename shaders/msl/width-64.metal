// Generated from shaders/wgsl/width-64.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_units[16];
metal::float4 irradia_sums[16];

static constant constexpr const uint irradia_blocks = 16u;

static constant constexpr const uint irradia_row_stride = 64u;

static constant constexpr const uint irradia_matrix = 1024u;
