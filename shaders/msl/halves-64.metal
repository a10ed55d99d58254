// Generated from shaders/wgsl/halves-64.wgsl by `npm run shaders` in web/: don't edit.

metal::half4 irradia_halves[16];

static constant constexpr const uint irradia_column_texels = 8u;

static constant constexpr const uint irradia_row_texels = 32u;
