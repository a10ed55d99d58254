// Generated from shaders/wgsl/halves-64.wgsl by `npm run shaders` in web/: don't edit.

static const uint irradia_column_texels = 8u;

static const uint irradia_row_texels = 32u;

static half4 irradia_halves[16];
