// Generated from shaders/wgsl/value-8.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

vec4 irradia_table_sums[4];

void irradia_table_clear() {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        irradia_table_sums[i] = vec4(0.0);
    }
}

float irradia_table_scale(uint first, uint block) {
    float _e3 = irradia_scale((first + block));
    return _e3;
}

void irradia_table_add(uvec4 words, float weight) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        ivec4 bytes = ivec4((uvec4(words[i]) << uvec4(24u, 16u, 8u, 0u))) >> uvec4(24u);
        irradia_table_sums[i] = irradia_table_sums[i] + (weight * vec4(bytes));
    }
}

void irradia_table_push(uint column, uint count) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        for (uint j = 0u; j < 4u; j += 1u) {
            uint feature = (4u * i) + j;
            if (feature < count) {
                float _e24 = irradia_table_sums[i][j];
                irradia_push((column + feature), _e24);
            }
        }
    }
}
