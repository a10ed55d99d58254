// Generated from shaders/wgsl/width-64.wgsl by `npm run shaders` in web/: don't edit.

static const uint irradia_blocks = 16u;

static const uint irradia_row_stride = 64u;

static const uint irradia_matrix = 1024u;

static float4 irradia_units[16];

static float4 irradia_sums[16];
