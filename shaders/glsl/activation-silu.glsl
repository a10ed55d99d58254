// Generated from shaders/wgsl/activation-silu.wgsl by `npm run shaders` in web/: don't edit.

vec4 irradia_activation(vec4 z) {
    return z / (vec4(1.0) + exp(min(-(z), vec4(80.0))));
}
