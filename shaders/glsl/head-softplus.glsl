// Generated from shaders/wgsl/head-softplus.wgsl by `npm run shaders` in web/: don't edit.

vec3 irradia_head(vec3 z) {
    vec3 e = exp(-(abs(z)));
    return max(z, vec3(0.0)) + mix(log((vec3(1.0) + e)), (e - ((0.5 * e) * e)), lessThan(e, vec3(0.001)));
}

vec3 irradia_head_unclamped(vec3 z) {
    vec3 _e1 = irradia_head(z);
    return _e1;
}
