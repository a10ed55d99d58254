// Generated from shaders/wgsl/width-32.wgsl by `npm run shaders` in web/: don't edit.

static const uint irradia_blocks = 8u;

static const uint irradia_row_stride = 32u;

static const uint irradia_matrix = 256u;

static float4 irradia_units[8];

static float4 irradia_sums[8];
