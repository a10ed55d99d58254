// Generated from shaders/wgsl/directional-mono-sh.wgsl by `npm run shaders` in web/: don't edit.

float irradia_mono_lobe(
    metal::float3 direction,
    metal::float3 normal,
    metal::float3 surface_normal
) {
    float t = 2.0 * metal::dot(direction, normal);
    float r = metal::min(metal::length(direction), 1.0);
    float cosine = metal::dot(normal, surface_normal);
    float bent = metal::max(1.0 - (cosine * cosine), 0.0);
    return metal::max(t + metal::sqrt((t * t) + (((1.0 - r) * (1.0 + (2.0 * r))) * bent)), 0.0);
}
