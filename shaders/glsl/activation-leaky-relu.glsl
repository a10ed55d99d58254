// Generated from shaders/wgsl/activation-leaky-relu.wgsl by `npm run shaders` in web/: don't edit.

vec4 irradia_activation(vec4 z) {
    return max(z, (0.01 * z));
}
