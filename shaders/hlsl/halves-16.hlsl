// Generated from shaders/wgsl/halves-16.wgsl by `npm run shaders` in web/: don't edit.

static const uint irradia_column_texels = 2u;

static const uint irradia_row_texels = 8u;

static half4 irradia_halves[4];
