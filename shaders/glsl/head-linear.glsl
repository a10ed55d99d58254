// Generated from shaders/wgsl/head-linear.wgsl by `npm run shaders` in web/: don't edit.

vec3 irradia_head(vec3 z) {
    return z;
}

vec3 irradia_head_unclamped(vec3 z) {
    return z;
}
