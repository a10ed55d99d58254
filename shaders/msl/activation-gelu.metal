// Generated from shaders/wgsl/activation-gelu.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_activation(
    metal::float4 z
) {
    metal::float4 twice = 1.5957692 * (z + (((0.044715 * z) * z) * z));
    return z / (metal::float4(1.0) + metal::exp(metal::min(-(twice), metal::float4(80.0))));
}
