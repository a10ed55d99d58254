// Generated from shaders/wgsl/light-irradiance.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, head

vec3 irradia_light(vec3 position, vec3 normal) {
    irradia_run(position, normal);
    vec4 _e3 = irradia_output(0u);
    vec3 _e5 = irradia_head(_e3.xyz);
    vec4 _e7 = irradia_constant(0u);
    vec3 light = _e5 * _e7.w;
    return max(light, vec3(0.0));
}

vec3 irradia_view_unclamped(vec3 position, vec3 normal) {
    irradia_run(position, normal);
    vec4 _e3 = irradia_output(0u);
    vec3 _e5 = irradia_head_unclamped(_e3.xyz);
    vec4 _e7 = irradia_constant(0u);
    return _e5 * _e7.w;
}
