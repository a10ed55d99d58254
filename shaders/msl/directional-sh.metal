// Generated from shaders/wgsl/directional-sh.wgsl by `npm run shaders` in web/: don't edit.

metal::float3 irradia_sh_lobes(
    metal::float3 x,
    metal::float3 y,
    metal::float3 z,
    metal::float3 normal,
    metal::float3 surface_normal
) {
    metal::float3 t = 2.0 * (((x * normal.x) + (y * normal.y)) + (z * normal.z));
    metal::float3 r = metal::min(metal::sqrt(((x * x) + (y * y)) + (z * z)), metal::float3(1.0));
    float cosine = metal::dot(normal, surface_normal);
    float bent = metal::max(1.0 - (cosine * cosine), 0.0);
    return metal::max(t + metal::sqrt((t * t) + (((metal::float3(1.0) - r) * (metal::float3(1.0) + (2.0 * r))) * bent)), metal::float3(0.0));
}
