// Generated from shaders/wgsl/directional-rnm.wgsl by `npm run shaders` in web/: don't edit.

float3 irradia_rnm_weights(float3 normal, float3 surface_normal, float4 tangent)
{
    float3 bitangent = cross(surface_normal, tangent.xyz) * tangent.w;
    float3 t = float3(dot(normal, tangent.xyz), dot(normal, bitangent), dot(normal, surface_normal));
    float along = 0.57735026 * t.z;
    float3 cosines = float3(((0.8164966 * t.x) + along), (((-0.4082483 * t.x) + (0.70710677 * t.y)) + along), (((-0.4082483 * t.x) - (0.70710677 * t.y)) + along));
    return max(cosines, (0.0).xxx);
}
