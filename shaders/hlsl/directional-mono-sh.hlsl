// Generated from shaders/wgsl/directional-mono-sh.wgsl by `npm run shaders` in web/: don't edit.

float irradia_mono_lobe(float3 direction, float3 normal, float3 surface_normal)
{
    float t = 2.0 * dot(direction, normal);
    float r = min(length(direction), 1.0);
    float cosine = dot(normal, surface_normal);
    float bent = max((1.0 - (cosine * cosine)), 0.0);
    return max((t + sqrt(((t * t) + (((1.0 - r) * (1.0 + (2.0 * r))) * bent)))), 0.0);
}
