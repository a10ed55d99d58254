// Generated from shaders/wgsl/constants-uniform.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: var<uniform> irradia_constants: array<vec4f>

metal::float4 irradia_constant(
    uint at
) {
    return irradia_constants[at];
}
