// Generated from shaders/wgsl/directional-dominant.wgsl by `npm run shaders` in web/: don't edit.

float irradia_dominant_share(float3 direction, float3 normal, float3 surface_normal)
{
    float lit_ = max((0.5 + (0.5 * dot(normal, direction))), 0.0);
    float own = max((0.5 + (0.5 * dot(surface_normal, direction))), 0.0001);
    return lit_ / own;
}
