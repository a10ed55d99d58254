// Generated from shaders/wgsl/field.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron
// given, in WGSL: fn irradia_encode(unit: vec3f, normal: vec3f)

float3 irradia_unit_position(float3 position)
{
    const float4 _e2 = irradia_constant(0u);
    const float4 _e6 = irradia_constant(1u);
    float3 x = (position - _e2.xyz) / _e6.xyz;
    return clamp(x, (0.0).xxx, (1.0).xxx);
}

void irradia_run(float3 position, float3 normal)
{
    irradia_begin();
    const float3 _e2 = irradia_unit_position(position);
    irradia_encode(_e2, normal);
    irradia_hidden_layers();
}
