// Generated from shaders/wgsl/directional-sh.wgsl by `npm run shaders` in web/: don't edit.

vec3 irradia_sh_lobes(vec3 x, vec3 y, vec3 z, vec3 normal, vec3 surface_normal) {
    vec3 t = 2.0 * (((x * normal.x) + (y * normal.y)) + (z * normal.z));
    vec3 r = min(sqrt((((x * x) + (y * y)) + (z * z))), vec3(1.0));
    float cosine = dot(normal, surface_normal);
    float bent = max((1.0 - (cosine * cosine)), 0.0);
    return max((t + sqrt(((t * t) + (((vec3(1.0) - r) * (vec3(1.0) + (2.0 * r))) * bent)))), vec3(0.0));
}
