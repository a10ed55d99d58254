// Generated from shaders/wgsl/field.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron
// given, in WGSL: fn irradia_encode(unit: vec3f, normal: vec3f)

metal::float3 irradia_unit_position(
    metal::float3 position
) {
    metal::float4 _e2 = irradia_constant(0u);
    metal::float4 _e6 = irradia_constant(1u);
    metal::float3 x = (position - _e2.xyz) / _e6.xyz;
    return metal::clamp(x, metal::float3(0.0), metal::float3(1.0));
}

void irradia_run(
    metal::float3 position,
    metal::float3 normal
) {
    irradia_begin();
    metal::float3 _e2 = irradia_unit_position(position);
    irradia_encode(_e2, normal);
    irradia_hidden_layers();
}
