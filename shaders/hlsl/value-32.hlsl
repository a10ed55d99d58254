// Generated from shaders/wgsl/value-32.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron

static float4 irradia_table_sums = (float4)0;

void irradia_table_clear()
{
    irradia_table_sums = (0.0).xxxx;
    return;
}

float irradia_table_scale(uint first, uint block)
{
    return 1.0;
}

void irradia_table_add(uint4 words, float weight)
{
    float4 _e3 = irradia_table_sums;
    irradia_table_sums = (_e3 + (weight * asfloat(words)));
    return;
}

void irradia_table_push(uint column, uint count)
{

    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e7 = i;
        if ((_e7 < count)) {
            uint _e9 = i;
            uint _e12 = i;
            float _e14 = irradia_table_sums[_e12];
            irradia_push((column + _e9), _e14);
        }
    }
    return;
}
