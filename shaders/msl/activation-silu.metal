// Generated from shaders/wgsl/activation-silu.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_activation(
    metal::float4 z
) {
    return z / (metal::float4(1.0) + metal::exp(metal::min(-(z), metal::float4(80.0))));
}
