// Generated from shaders/wgsl/value-4.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

vec4 irradia_table_lower[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));

vec4 irradia_table_upper[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));

void irradia_table_clear() {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e6 = i;
        irradia_table_lower[_e6] = vec4(0.0);
        uint _e11 = i;
        irradia_table_upper[_e11] = vec4(0.0);
    }
    return;
}

float irradia_table_scale(uint first, uint block) {
    float _e3 = irradia_scale((first + block));
    return _e3;
}

void irradia_table_add(uvec4 words, float weight) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e7 = i;
        uvec4 lower = ((uvec4(words[_e7]) >> uvec4(0u, 4u, 8u, 12u)) & uvec4(15u));
        uint _e19 = i;
        uvec4 upper = ((uvec4(words[_e19]) >> uvec4(16u, 20u, 24u, 28u)) & uvec4(15u));
        uint _e32 = i;
        vec4 _e34 = irradia_table_lower[_e32];
        irradia_table_lower[_e32] = (_e34 + (weight * (vec4(lower) - vec4(8.0))));
        uint _e42 = i;
        vec4 _e44 = irradia_table_upper[_e42];
        irradia_table_upper[_e42] = (_e44 + (weight * (vec4(upper) - vec4(8.0))));
    }
    return;
}

void irradia_table_push(uint column, uint count) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        for (uint j = 0u; j < 4u; j += 1u) {
            uint _e13 = i;
            uint _e15 = j;
            uint feature = ((8u * _e13) + _e15);
            if ((feature < count)) {
                uint _e20 = i;
                uint _e22 = j;
                float _e24 = irradia_table_lower[_e20][_e22];
                irradia_push((column + feature), _e24);
            }
            if (((feature + 4u) < count)) {
                uint _e32 = i;
                uint _e34 = j;
                float _e36 = irradia_table_upper[_e32][_e34];
                irradia_push(((column + feature) + 4u), _e36);
            }
        }
    }
    return;
}
