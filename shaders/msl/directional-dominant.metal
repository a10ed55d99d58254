// Generated from shaders/wgsl/directional-dominant.wgsl by `npm run shaders` in web/: don't edit.

float irradia_dominant_share(
    metal::float3 direction,
    metal::float3 normal,
    metal::float3 surface_normal
) {
    float lit = metal::max(0.5 + (0.5 * metal::dot(normal, direction)), 0.0);
    float own = metal::max(0.5 + (0.5 * metal::dot(surface_normal, direction)), 0.0001);
    return lit / own;
}
