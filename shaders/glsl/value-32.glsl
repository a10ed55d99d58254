// Generated from shaders/wgsl/value-32.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron

vec4 irradia_table_sums;

void irradia_table_clear() {
    irradia_table_sums = vec4(0.0);
}

float irradia_table_scale(uint first, uint block) {
    return 1.0;
}

void irradia_table_add(uvec4 words, float weight) {
    irradia_table_sums = irradia_table_sums + (weight * uintBitsToFloat(words));
}

void irradia_table_push(uint column, uint count) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        if (i < count) {
            float _e14 = irradia_table_sums[i];
            irradia_push((column + i), _e14);
        }
    }
}
