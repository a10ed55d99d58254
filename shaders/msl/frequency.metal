// Generated from shaders/wgsl/frequency.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron, sine

void irradia_frequency(
    uint record,
    metal::float3 x
) {
    uint column = {};
    float half_turns = {};
    metal::float4 _e2 = irradia_constant(record);
    metal::uint3 shape = naga_f2u32(_e2.xyz);
    column = shape.x;
    if (shape.z == 1u) {
        for (uint axis = 0u; axis < 3u; axis += 1u) {
            irradia_push(column + axis, x[axis]);
        }
        column = column + 3u;
    }
    for (uint axis_1 = 0u; axis_1 < 3u; axis_1 += 1u) {
        half_turns = x[axis_1];
        for (uint k = 0u; k < shape.y; k += 1u) {
            float _e41 = irradia_sine_of_half_turns(half_turns);
            irradia_push(column, _e41);
            float _e46 = irradia_cosine_of_half_turns(half_turns);
            irradia_push(column + 1u, _e46);
            half_turns = half_turns * 2.0;
            column = column + 2u;
        }
    }
}
