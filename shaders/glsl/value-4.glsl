// Generated from shaders/wgsl/value-4.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

vec4 irradia_table_lower[4];

vec4 irradia_table_upper[4];

void irradia_table_clear() {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        irradia_table_lower[i] = vec4(0.0);
        irradia_table_upper[i] = vec4(0.0);
    }
}

float irradia_table_scale(uint first, uint block) {
    float _e3 = irradia_scale((first + block));
    return _e3;
}

void irradia_table_add(uvec4 words, float weight) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uvec4 lower = (uvec4(words[i]) >> uvec4(0u, 4u, 8u, 12u)) & uvec4(15u);
        uvec4 upper = (uvec4(words[i]) >> uvec4(16u, 20u, 24u, 28u)) & uvec4(15u);
        irradia_table_lower[i] = irradia_table_lower[i] + (weight * (vec4(lower) - vec4(8.0)));
        irradia_table_upper[i] = irradia_table_upper[i] + (weight * (vec4(upper) - vec4(8.0)));
    }
}

void irradia_table_push(uint column, uint count) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        for (uint j = 0u; j < 4u; j += 1u) {
            uint feature = (8u * i) + j;
            if (feature < count) {
                float _e24 = irradia_table_lower[i][j];
                irradia_push((column + feature), _e24);
            }
            if ((feature + 4u) < count) {
                float _e36 = irradia_table_upper[i][j];
                irradia_push(((column + feature) + 4u), _e36);
            }
        }
    }
}
