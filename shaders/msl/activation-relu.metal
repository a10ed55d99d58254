// Generated from shaders/wgsl/activation-relu.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_activation(
    metal::float4 z
) {
    return metal::max(z, metal::float4(0.0));
}
