// Generated from shaders/wgsl/field.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron
// given, in WGSL: fn irradia_encode(unit: vec3f, normal: vec3f)

vec3 irradia_unit_position(vec3 position) {
    vec4 _e2 = irradia_constant(0u);
    vec4 _e6 = irradia_constant(1u);
    vec3 x = (position - _e2.xyz) / _e6.xyz;
    return clamp(x, vec3(0.0), vec3(1.0));
}

void irradia_run(vec3 position, vec3 normal) {
    irradia_begin();
    vec3 _e2 = irradia_unit_position(position);
    irradia_encode(_e2, normal);
    irradia_hidden_layers();
}
