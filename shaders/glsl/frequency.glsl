// Generated from shaders/wgsl/frequency.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron, sine

void irradia_frequency(uint record, vec3 x) {
    uint column = 0u;
    float half_turns = 0.0;
    vec4 _e2 = irradia_constant(record);
    uvec3 shape = uvec3(_e2.xyz);
    column = shape.x;
    if ((shape.z == 1u)) {
        for (uint axis = 0u; axis < 3u; axis += 1u) {
            uint _e15 = column;
            uint _e16 = axis;
            uint _e18 = axis;
            irradia_push((_e15 + _e16), x[_e18]);
        }
        uint _e23 = column;
        column = (_e23 + 3u);
    }
    for (uint axis_1 = 0u; axis_1 < 3u; axis_1 += 1u) {
        uint _e31 = axis_1;
        half_turns = x[_e31];
        for (uint k = 0u; k < shape.y; k += 1u) {
            uint _e39 = column;
            float _e40 = half_turns;
            float _e41 = irradia_sine_of_half_turns(_e40);
            irradia_push(_e39, _e41);
            uint _e42 = column;
            float _e45 = half_turns;
            float _e46 = irradia_cosine_of_half_turns(_e45);
            irradia_push((_e42 + 1u), _e46);
            float _e47 = half_turns;
            half_turns = (_e47 * 2.0);
            uint _e50 = column;
            column = (_e50 + 2u);
        }
    }
    return;
}
