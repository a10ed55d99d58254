// Generated from shaders/wgsl/value-8.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

metal::float4 irradia_table_sums[4];

void irradia_table_clear() {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        irradia_table_sums[i] = metal::float4(0.0);
    }
}

float irradia_table_scale(
    uint first,
    uint block
) {
    float _e3 = irradia_scale(first + block);
    return _e3;
}

void irradia_table_add(
    metal::uint4 words,
    float weight
) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        metal::int4 bytes = as_type<metal::int4>(metal::uint4(words[i]) << metal::uint4(24u, 16u, 8u, 0u)) >> metal::uint4(24u);
        irradia_table_sums[i] = irradia_table_sums[i] + (weight * static_cast<metal::float4>(bytes));
    }
}

void irradia_table_push(
    uint column,
    uint count
) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        for (uint j = 0u; j < 4u; j += 1u) {
            uint feature = (4u * i) + j;
            if (feature < count) {
                float _e24 = irradia_table_sums[i][j];
                irradia_push(column + feature, _e24);
            }
        }
    }
}
