// Generated from shaders/wgsl/halves-16.wgsl by `npm run shaders` in web/: don't edit.

metal::half4 irradia_halves[4];

static constant constexpr const uint irradia_column_texels = 2u;

static constant constexpr const uint irradia_row_texels = 8u;
