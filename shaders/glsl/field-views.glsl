// Generated from shaders/wgsl/field-views.wgsl by `npm run shaders` in web/: don't edit.
// needs: field

vec3 irradia_view_raw(vec3 position, vec3 normal) {
    irradia_run(position, normal);
    vec4 _e3 = irradia_output(0u);
    return _e3.xyz;
}

vec3 irradia_view_hidden(vec3 position, vec3 normal) {
    irradia_run(position, normal);
    vec3 units = irradia_units[0].xyz;
    return vec3(0.5) + ((0.5 * units) / (vec3(1.0) + abs(units)));
}

vec3 irradia_view_position(vec3 position, vec3 normal) {
    vec3 _e2 = irradia_unit_position(position);
    return _e2;
}
