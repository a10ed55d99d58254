// Generated from shaders/wgsl/constants-uniform.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: var<uniform> irradia_constants: array<vec4f>

float4 irradia_constant(uint at)
{
    float4 _e3 = irradia_constants[at];
    return _e3;
}
