// Generated from shaders/wgsl/scales.wgsl by `npm run shaders` in web/: don't edit.
// needs: constants

float irradia_scale(uint at) {
    vec4 _e3 = irradia_constant((at >> 2u));
    return _e3[(at & 3u)];
}
