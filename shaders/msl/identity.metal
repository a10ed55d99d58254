// Generated from shaders/wgsl/identity.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron

void irradia_identity(
    uint record,
    metal::float3 x
) {
    metal::float4 _e2 = irradia_constant(record);
    uint column = naga_f2u32(_e2.x);
    irradia_push(column, x.x);
    irradia_push(column + 1u, x.y);
    irradia_push(column + 2u, x.z);
}
