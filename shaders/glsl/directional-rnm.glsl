// Generated from shaders/wgsl/directional-rnm.wgsl by `npm run shaders` in web/: don't edit.

vec3 irradia_rnm_weights(vec3 normal, vec3 surface_normal, vec4 tangent) {
    vec3 bitangent = cross(surface_normal, tangent.xyz) * tangent.w;
    vec3 t = vec3(dot(normal, tangent.xyz), dot(normal, bitangent), dot(normal, surface_normal));
    float along = 0.57735026 * t.z;
    vec3 cosines = vec3(((0.8164966 * t.x) + along), (((-0.4082483 * t.x) + (0.70710677 * t.y)) + along), (((-0.4082483 * t.x) - (0.70710677 * t.y)) + along));
    return max(cosines, vec3(0.0));
}
