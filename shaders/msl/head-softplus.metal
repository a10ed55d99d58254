// Generated from shaders/wgsl/head-softplus.wgsl by `npm run shaders` in web/: don't edit.

metal::float3 irradia_head(
    metal::float3 z
) {
    metal::float3 e = metal::exp(-(metal::abs(z)));
    return metal::max(z, metal::float3(0.0)) + metal::select(metal::log(metal::float3(1.0) + e), e - ((0.5 * e) * e), e < metal::float3(0.001));
}

metal::float3 irradia_head_unclamped(
    metal::float3 z
) {
    metal::float3 _e1 = irradia_head(z);
    return _e1;
}
