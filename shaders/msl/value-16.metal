// Generated from shaders/wgsl/value-16.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron

metal::float2 irradia_table_sums[4];

void irradia_table_clear() {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        irradia_table_sums[i] = metal::float2(0.0);
    }
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
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        irradia_table_sums[i] = irradia_table_sums[i] + (weight * float2(as_type<half2>(words[i])));
    }
}

void irradia_table_push(
    uint column,
    uint count
) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint first = 2u * i;
        if (first < count) {
            float _e16 = irradia_table_sums[i].x;
            irradia_push(column + first, _e16);
        }
        if ((first + 1u) < count) {
            float _e27 = irradia_table_sums[i].y;
            irradia_push((column + first) + 1u, _e27);
        }
    }
}
