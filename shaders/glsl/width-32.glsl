// Generated from shaders/wgsl/width-32.wgsl by `npm run shaders` in web/: don't edit.

const uint irradia_blocks = 8u;

const uint irradia_row_stride = 32u;

const uint irradia_matrix = 256u;

vec4 irradia_units[8];

vec4 irradia_sums[8];
