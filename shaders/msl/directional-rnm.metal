// Generated from shaders/wgsl/directional-rnm.wgsl by `npm run shaders` in web/: don't edit.

metal::float3 irradia_rnm_weights(
    metal::float3 normal,
    metal::float3 surface_normal,
    metal::float4 tangent
) {
    metal::float3 bitangent = metal::cross(surface_normal, tangent.xyz) * tangent.w;
    metal::float3 t = metal::float3(metal::dot(normal, tangent.xyz), metal::dot(normal, bitangent), metal::dot(normal, surface_normal));
    float along = 0.57735026 * t.z;
    metal::float3 cosines = metal::float3((0.8164966 * t.x) + along, ((-0.4082483 * t.x) + (0.70710677 * t.y)) + along, ((-0.4082483 * t.x) - (0.70710677 * t.y)) + along);
    return metal::max(cosines, metal::float3(0.0));
}
