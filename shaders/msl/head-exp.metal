// Generated from shaders/wgsl/head-exp.wgsl by `npm run shaders` in web/: don't edit.

metal::float3 irradia_head(
    metal::float3 z
) {
    return metal::exp(metal::clamp(z, metal::float3(-15.0), metal::float3(15.0)));
}

metal::float3 irradia_head_unclamped(
    metal::float3 z
) {
    return metal::exp(z);
}
