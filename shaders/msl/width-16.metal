// Generated from shaders/wgsl/width-16.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_units[4];
metal::float4 irradia_sums[4];

static constant constexpr const uint irradia_blocks = 4u;

static constant constexpr const uint irradia_row_stride = 16u;

static constant constexpr const uint irradia_matrix = 64u;
