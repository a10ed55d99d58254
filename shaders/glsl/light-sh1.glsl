// Generated from shaders/wgsl/light-sh1.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, cosine-lobe

vec3 irradia_view_unclamped(vec3 position, vec3 normal) {
    irradia_run(position, normal);
    vec4 _e3 = irradia_output(0u);
    vec4 _e5 = irradia_output(1u);
    vec4 _e7 = irradia_output(2u);
    vec4 _e8 = irradia_lobe_linear(normal);
    vec3 light = (((_e8.x * _e3.xyz) + (_e8.y * vec3(_e3.w, _e5.xy))) + (_e8.z * vec3(_e5.zw, _e7.x))) + (_e8.w * _e7.yzw);
    vec4 _e29 = irradia_constant(0u);
    return light * _e29.w;
}

vec3 irradia_light(vec3 position, vec3 normal) {
    vec3 _e2 = irradia_view_unclamped(position, normal);
    return max(_e2, vec3(0.0));
}
