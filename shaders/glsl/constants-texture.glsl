// Generated from shaders/wgsl/constants-texture.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: var irradia_constants: texture_2d_array<f32>

vec4 irradia_constant(uint at) {
    vec4 _e9 = texelFetch(irradia_constants, ivec3(uvec2((at & 255u), (at >> 8u)), 0), 0);
    return _e9;
}
