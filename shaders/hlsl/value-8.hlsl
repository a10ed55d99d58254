// Generated from shaders/wgsl/value-8.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron, scales

static float4 irradia_table_sums[4] = (float4[4])0;

void irradia_table_clear()
{

    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e6 = i;
        irradia_table_sums[_e6] = (0.0).xxxx;
    }
    return;
}

float irradia_table_scale(uint first, uint block)
{
    const float _e3 = irradia_scale((first + block));
    return _e3;
}

void irradia_table_add(uint4 words, float weight)
{

    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e7 = i;
        int4 bytes = (asint(((words[_e7]).xxxx << uint4(24u, 16u, 8u, 0u))) >> (24u).xxxx);
        uint _e21 = i;
        float4 _e23 = irradia_table_sums[_e21];
        irradia_table_sums[_e21] = (_e23 + (weight * float4(bytes)));
    }
    return;
}

void irradia_table_push(uint column, uint count)
{

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
