// Generated from shaders/wgsl/shadow-mask.wgsl by `npm run shaders` in web/: don't edit.

float irradia_shadow(
    metal::float4 mask,
    int channel
) {
    metal::int4 lights = metal::int4(0, 1, 2, 3);
    metal::float4 own = metal::select(metal::float4(0.0), mask, lights == metal::int4(channel));
    return (channel < 0) ? 1.0 : (((own.x + own.y) + own.z) + own.w);
}
