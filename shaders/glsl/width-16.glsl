// Generated from shaders/wgsl/width-16.wgsl by `npm run shaders` in web/: don't edit.

const uint irradia_blocks = 4u;

const uint irradia_row_stride = 16u;

const uint irradia_matrix = 64u;

vec4 irradia_units[4];

vec4 irradia_sums[4];
