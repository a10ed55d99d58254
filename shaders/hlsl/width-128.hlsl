// Generated from shaders/wgsl/width-128.wgsl by `npm run shaders` in web/: don't edit.

static const uint irradia_blocks = 32u;

static const uint irradia_row_stride = 128u;

static const uint irradia_matrix = 4096u;

static float4 irradia_units[32];

static float4 irradia_sums[32];
