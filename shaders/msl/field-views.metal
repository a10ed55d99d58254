// Generated from shaders/wgsl/field-views.wgsl by `npm run shaders` in web/: don't edit.
// needs: field

metal::float3 irradia_view_raw(
    metal::float3 position,
    metal::float3 normal
) {
    irradia_run(position, normal);
    metal::float4 _e3 = irradia_output(0u);
    return _e3.xyz;
}

metal::float3 irradia_view_hidden(
    metal::float3 position,
    metal::float3 normal
) {
    irradia_run(position, normal);
    metal::float3 units = irradia_units[0].xyz;
    return metal::float3(0.5) + ((0.5 * units) / (metal::float3(1.0) + metal::abs(units)));
}

metal::float3 irradia_view_position(
    metal::float3 position,
    metal::float3 normal
) {
    metal::float3 _e2 = irradia_unit_position(position);
    return _e2;
}
