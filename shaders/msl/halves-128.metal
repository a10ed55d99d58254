// Generated from shaders/wgsl/halves-128.wgsl by `npm run shaders` in web/: don't edit.

metal::half4 irradia_halves[32];

static constant constexpr const uint irradia_column_texels = 16u;

static constant constexpr const uint irradia_row_texels = 64u;
