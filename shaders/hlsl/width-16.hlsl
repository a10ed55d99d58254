// Generated from shaders/wgsl/width-16.wgsl by `npm run shaders` in web/: don't edit.

static const uint irradia_blocks = 4u;

static const uint irradia_row_stride = 16u;

static const uint irradia_matrix = 64u;

static float4 irradia_units[4];

static float4 irradia_sums[4];
