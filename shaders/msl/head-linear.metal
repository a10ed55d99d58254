// Generated from shaders/wgsl/head-linear.wgsl by `npm run shaders` in web/: don't edit.

metal::float3 irradia_head(
    metal::float3 z
) {
    return z;
}

metal::float3 irradia_head_unclamped(
    metal::float3 z
) {
    return z;
}
