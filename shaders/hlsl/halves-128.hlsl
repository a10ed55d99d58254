// Generated from shaders/wgsl/halves-128.wgsl by `npm run shaders` in web/: don't edit.

static const uint irradia_column_texels = 16u;

static const uint irradia_row_texels = 64u;

static half4 irradia_halves[32];
