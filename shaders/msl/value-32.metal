// Generated from shaders/wgsl/value-32.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron

metal::float4 irradia_table_sums;

void irradia_table_clear() {
    irradia_table_sums = metal::float4(0.0);
    return;
}

float irradia_table_scale(
    uint first,
    uint block
) {
    return 1.0;
}

void irradia_table_add(
    metal::uint4 words,
    float weight
) {
    metal::float4 _e3 = irradia_table_sums;
    irradia_table_sums = _e3 + (weight * as_type<metal::float4>(words));
    return;
}

void irradia_table_push(
    uint column,
    uint count
) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e7 = i;
        if (_e7 < count) {
            uint _e9 = i;
            uint _e12 = i;
            float _e14 = irradia_table_sums[_e12];
            irradia_push(column + _e9, _e14);
        }
    }
    return;
}
