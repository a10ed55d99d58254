// Generated from shaders/wgsl/light-sh2.wgsl by `npm run shaders` in web/: don't edit.
// needs: field, cosine-lobe

vec3 irradia_view_unclamped(vec3 position, vec3 normal) {
    vec3 light = vec3(0.0);
    irradia_run(position, normal);
    vec4 _e2 = irradia_lobe_linear(normal);
    vec4 _e3 = irradia_lobe_quadratic(normal);
    for (uint three = 0u; three < 6u; three += 3u) {
        vec4 weights = (three == 0u) ? _e2 : _e3;
        vec4 _e17 = irradia_output(three);
        vec4 _e21 = irradia_output((three + 1u));
        vec4 _e25 = irradia_output((three + 2u));
        light = light + (weights.x * _e17.xyz);
        light = light + (weights.y * vec3(_e17.w, _e21.xy));
        light = light + (weights.z * vec3(_e21.zw, _e25.x));
        light = light + (weights.w * _e25.yzw);
    }
    float _e54 = irradia_lobe_squares(normal);
    vec4 _e56 = irradia_output(6u);
    light = light + (_e54 * _e56.xyz);
    vec4 _e62 = irradia_constant(0u);
    return light * _e62.w;
}

vec3 irradia_light(vec3 position, vec3 normal) {
    vec3 _e2 = irradia_view_unclamped(position, normal);
    return max(_e2, vec3(0.0));
}
