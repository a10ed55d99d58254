// Generated from shaders/wgsl/value-16.wgsl by `npm run shaders` in web/: don't edit.
// needs: words, perceptron

static float2 irradia_table_sums[4] = (float2[4])0;

void irradia_table_clear()
{

    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e6 = i;
        irradia_table_sums[_e6] = (0.0).xx;
    }
    return;
}

float irradia_table_scale(uint first, uint block)
{
    return 1.0;
}

void irradia_table_add(uint4 words, float weight)
{

    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e8 = i;
        float2 _e10 = irradia_table_sums[_e8];
        uint _e11 = i;
        uint _e12 = words[_e11];
        irradia_table_sums[_e8] = (_e10 + (weight * float2(f16tof32(_e12), f16tof32((_e12) >> 16))));
    }
    return;
}

void irradia_table_push(uint column, uint count)
{

    for (uint i = 0u; i < irradia_table_words; i += 1u) {
        uint _e8 = i;
        uint first = (2u * _e8);
        if ((first < count)) {
            uint _e13 = i;
            float _e16 = irradia_table_sums[_e13].x;
            irradia_push((column + first), _e16);
        }
        if (((first + 1u) < count)) {
            uint _e24 = i;
            float _e27 = irradia_table_sums[_e24].y;
            irradia_push(((column + first) + 1u), _e27);
        }
    }
    return;
}
