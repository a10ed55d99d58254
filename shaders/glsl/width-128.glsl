// Generated from shaders/wgsl/width-128.wgsl by `npm run shaders` in web/: don't edit.

const uint irradia_blocks = 32u;

const uint irradia_row_stride = 128u;

const uint irradia_matrix = 4096u;

vec4 irradia_units[32];

vec4 irradia_sums[32];
