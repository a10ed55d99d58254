// Generated from shaders/wgsl/activation-sine.wgsl by `npm run shaders` in web/: don't edit.
// needs: sine

metal::float4 irradia_activation(
    metal::float4 z
) {
    metal::float4 _e1 = irradia_sine(z);
    return _e1;
}
