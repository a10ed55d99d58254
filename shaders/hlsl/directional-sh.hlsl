// Generated from shaders/wgsl/directional-sh.wgsl by `npm run shaders` in web/: don't edit.

float3 irradia_sh_lobes(float3 x, float3 y, float3 z, float3 normal, float3 surface_normal)
{
    float3 t = 2.0 * (((x * normal.x) + (y * normal.y)) + (z * normal.z));
    float3 r = min(sqrt((((x * x) + (y * y)) + (z * z))), (1.0).xxx);
    float cosine = dot(normal, surface_normal);
    float bent = max((1.0 - (cosine * cosine)), 0.0);
    return max((t + sqrt(((t * t) + ((((1.0).xxx - r) * ((1.0).xxx + (2.0 * r))) * bent)))), (0.0).xxx);
}
