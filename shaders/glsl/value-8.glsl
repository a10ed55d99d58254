// Generated from shaders/wgsl/value-8.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

vec4 irradia_table_sums[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));

void irradia_table_clear() {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e6 = i;
        irradia_table_sums[_e6] = vec4(0.0);
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
        ivec4 bytes = (ivec4((uvec4(words[_e7]) << uvec4(24u, 16u, 8u, 0u))) >> uvec4(24u));
        uint _e21 = i;
        vec4 _e23 = irradia_table_sums[_e21];
        irradia_table_sums[_e21] = (_e23 + (weight * vec4(bytes)));
    }
    return;
}

void irradia_table_push(uint column, uint count) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        for (uint j = 0u; j < 4u; j += 1u) {
            uint _e13 = i;
            uint _e15 = j;
            uint feature = ((4u * _e13) + _e15);
            if ((feature < count)) {
                uint _e20 = i;
                uint _e22 = j;
                float _e24 = irradia_table_sums[_e20][_e22];
                irradia_push((column + feature), _e24);
            }
        }
    }
    return;
}
