// Generated from shaders/wgsl/halves-32.wgsl by `npm run shaders` in web/: don't edit.

metal::half4 irradia_halves[8];

static constant constexpr const uint irradia_column_texels = 4u;

static constant constexpr const uint irradia_row_texels = 16u;
