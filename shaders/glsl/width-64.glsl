// Generated from shaders/wgsl/width-64.wgsl by `npm run shaders` in web/: don't edit.

const uint irradia_blocks = 16u;

const uint irradia_row_stride = 64u;

const uint irradia_matrix = 1024u;

vec4 irradia_units[16];

vec4 irradia_sums[16];
