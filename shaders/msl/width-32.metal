// Generated from shaders/wgsl/width-32.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_units[8];
metal::float4 irradia_sums[8];

static constant constexpr const uint irradia_blocks = 8u;

static constant constexpr const uint irradia_row_stride = 32u;

static constant constexpr const uint irradia_matrix = 256u;
