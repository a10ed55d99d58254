// Generated from shaders/wgsl/activation-relu.wgsl by `npm run shaders` in web/: don't edit.

vec4 irradia_activation(vec4 z) {
    return max(z, vec4(0.0));
}
