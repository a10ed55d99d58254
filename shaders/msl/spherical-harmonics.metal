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
        uint _e26 = m;
        for (uint l = _e26; l < shape.y; l += 1u) {
            uint _e31 = at;
            metal::float4 _e32 = irradia_constant(_e31);
            float _e36 = last;
            float _e39 = before;
            float next = (((_e32.y * v.z) * _e36) - (_e32.z * _e39)) + _e32.w;
            uint _e45 = l;
            uint _e46 = l;
            uint centre = shape.x + (_e45 * (_e46 + 1u));
            uint _e51 = m;
            float _e56 = turn.x;
            irradia_push(centre + _e51, (_e32.x * next) * _e56);
            uint _e58 = m;
            if (_e58 > 0u) {
                uint _e61 = m;
                float _e66 = turn.y;
                irradia_push(centre - _e61, (_e32.x * next) * _e66);
            }
            float _e68 = last;
            before = _e68;
            last = next;
            uint _e69 = at;
            at = _e69 + 1u;
        }
        float _e77 = turn.x;
        float _e81 = turn.y;
        float _e86 = turn.y;
        float _e90 = turn.x;
        turn = metal::float2((v.x * _e77) - (v.y * _e81), (v.x * _e86) + (v.y * _e90));
    }
    return;
}
