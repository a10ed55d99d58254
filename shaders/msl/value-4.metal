// Generated from shaders/wgsl/value-4.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

metal::float4 irradia_table_lower[4];
metal::float4 irradia_table_upper[4];

void irradia_table_clear() {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        irradia_table_lower[i] = metal::float4(0.0);
        irradia_table_upper[i] = metal::float4(0.0);
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
        metal::uint4 lower = (metal::uint4(words[i]) >> metal::uint4(0u, 4u, 8u, 12u)) & metal::uint4(15u);
        metal::uint4 upper = (metal::uint4(words[i]) >> metal::uint4(16u, 20u, 24u, 28u)) & metal::uint4(15u);
        irradia_table_lower[i] = irradia_table_lower[i] + (weight * (static_cast<metal::float4>(lower) - metal::float4(8.0)));
        irradia_table_upper[i] = irradia_table_upper[i] + (weight * (static_cast<metal::float4>(upper) - metal::float4(8.0)));
    }
}

void irradia_table_push(
    uint column,
    uint count
) {
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        for (uint j = 0u; j < 4u; j += 1u) {
            uint feature = (8u * i) + j;
            if (feature < count) {
                float _e24 = irradia_table_lower[i][j];
                irradia_push(column + feature, _e24);
            }
            if ((feature + 4u) < count) {
                float _e36 = irradia_table_upper[i][j];
                irradia_push((column + feature) + 4u, _e36);
            }
        }
    }
}
