// Generated from shaders/wgsl/width-128.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_units[32];
metal::float4 irradia_sums[32];

static constant constexpr const uint irradia_blocks = 32u;

static constant constexpr const uint irradia_row_stride = 128u;

static constant constexpr const uint irradia_matrix = 4096u;
