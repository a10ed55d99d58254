// Generated from shaders/wgsl/spherical-harmonics.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron

void irradia_spherical_harmonics(
    uint record,
    metal::float3 unit
) {
    metal::float2 turn = metal::float2(1.0, 0.0);
    uint at = {};
    float before = {};
    float last = {};
    metal::float4 _e2 = irradia_constant(record);
    metal::uint2 shape = naga_f2u32(_e2.xy);
    metal::float3 v = (2.0 * unit) - metal::float3(1.0);
    at = record + 1u;
    for (uint m = 0u; m < shape.y; m += 1u) {
        before = 0.0;
        last = 0.0;
        for (uint l = m; l < shape.y; l += 1u) {
            metal::float4 _e32 = irradia_constant(at);
            float next = (((_e32.y * v.z) * last) - (_e32.z * before)) + _e32.w;
            uint centre = shape.x + (l * (l + 1u));
            irradia_push(centre + m, (_e32.x * next) * turn.x);
            if (m > 0u) {
                irradia_push(centre - m, (_e32.x * next) * turn.y);
            }
            before = last;
            last = next;
            at = at + 1u;
        }
        turn = metal::float2((v.x * turn.x) - (v.y * turn.y), (v.x * turn.y) + (v.y * turn.x));
    }
}
