// Generated from shaders/wgsl/value-8.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

static float4 irradia_table_sums[4];

void irradia_table_clear()
{
    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        irradia_table_sums[i] = (0.0).xxxx;
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
        int4 bytes = asint(((words[i]).xxxx << uint4(24u, 16u, 8u, 0u))) >> (24u).xxxx;
        irradia_table_sums[i] = irradia_table_sums[i] + (weight * float4(bytes));
    }
}

void irradia_table_push(uint column, uint count)
{
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
