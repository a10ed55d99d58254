// Generated from shaders/wgsl/activation-sine.wgsl by `npm run shaders` in web/: don't edit.
// needs: sine

vec4 irradia_activation(vec4 z) {
    vec4 _e1 = irradia_sine(z);
    return _e1;
}
