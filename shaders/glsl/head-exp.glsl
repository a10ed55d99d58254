// Generated from shaders/wgsl/head-exp.wgsl by `npm run shaders` in web/: don't edit.

vec3 irradia_head(vec3 z) {
    return exp(clamp(z, vec3(-15.0), vec3(15.0)));
}

vec3 irradia_head_unclamped(vec3 z) {
    return exp(z);
}
