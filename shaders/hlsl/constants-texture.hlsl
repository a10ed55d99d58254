// Generated from shaders/wgsl/constants-texture.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: var irradia_constants: texture_2d_array<f32>

float4 irradia_constant(uint at)
{
    float4 _e9 = irradia_constants.Load(int4(uint2((at & 255u), (at >> 8u)), int(0), int(0)));
    return _e9;
}
