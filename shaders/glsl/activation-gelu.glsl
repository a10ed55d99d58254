// Generated from shaders/wgsl/activation-gelu.wgsl by `npm run shaders` in web/: don't edit.

vec4 irradia_activation(vec4 z) {
    vec4 twice = 1.5957692 * (z + (((0.044715 * z) * z) * z));
    return z / (vec4(1.0) + exp(min(-(twice), vec4(80.0))));
}
