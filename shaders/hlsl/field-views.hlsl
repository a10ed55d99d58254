// Generated from shaders/wgsl/field-views.wgsl by `npm run shaders` in web/: don't edit.
// needs: field

float3 irradia_view_raw(float3 position, float3 normal)
{
    irradia_run(position, normal);
    const float4 _e3 = irradia_output(0u);
    return _e3.xyz;
}

float3 irradia_view_hidden(float3 position, float3 normal)
{
    irradia_run(position, normal);
    float3 units = irradia_units[0].xyz;
    return (0.5).xxx + ((0.5 * units) / ((1.0).xxx + abs(units)));
}

float3 irradia_view_position(float3 position, float3 normal)
{
    const float3 _e2 = irradia_unit_position(position);
    return _e2;
}
