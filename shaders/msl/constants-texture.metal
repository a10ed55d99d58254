// Generated from shaders/wgsl/constants-texture.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: var irradia_constants: texture_2d_array<f32>

metal::float4 irradia_constant(
    uint at
) {
    metal::float4 _e9 = irradia_constants.read(metal::uint2(metal::uint2(at & 255u, at >> 8u)), 0, 0);
    return _e9;
}
