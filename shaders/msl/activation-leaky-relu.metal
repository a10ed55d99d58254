// Generated from shaders/wgsl/activation-leaky-relu.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_activation(
    metal::float4 z
) {
    return metal::max(z, 0.01 * z);
}
