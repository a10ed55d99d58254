// Generated from shaders/wgsl/shadow-mask.wgsl by `npm run shaders` in web/: don't edit.

float irradia_shadow(vec4 mask, int channel) {
    ivec4 lights = ivec4(0, 1, 2, 3);
    vec4 own = mix(vec4(0.0), mask, equal(lights, ivec4(channel)));
    return (channel < 0) ? 1.0 : (((own.x + own.y) + own.z) + own.w);
}
