// Generated from shaders/wgsl/value-4.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

static float4 irradia_table_lower[4];

static float4 irradia_table_upper[4];

void irradia_table_clear()
{
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        irradia_table_lower[i] = (0.0).xxxx;
        irradia_table_upper[i] = (0.0).xxxx;
    }
}

float irradia_table_scale(uint first, uint block)
{
    const float _e3 = irradia_scale((first + block));
    return _e3;
}

void irradia_table_add(uint4 words, float weight)
{
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint4 lower = ((words[i]).xxxx >> uint4(0u, 4u, 8u, 12u)) & (15u).xxxx;
        uint4 upper = ((words[i]).xxxx >> uint4(16u, 20u, 24u, 28u)) & (15u).xxxx;
        irradia_table_lower[i] = irradia_table_lower[i] + (weight * (float4(lower) - (8.0).xxxx));
        irradia_table_upper[i] = irradia_table_upper[i] + (weight * (float4(upper) - (8.0).xxxx));
    }
}

void irradia_table_push(uint column, uint count)
{
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
