// Generated from shaders/wgsl/perceptron-float.wgsl by `npm run shaders` in web/: don't edit.
// needs: constants, width, activation

static uint2 irradia_first_matrix;

void irradia_begin()
{
    const float4 _e1 = irradia_constant(2u);
    irradia_first_matrix = naga_f2u32(_e1.xy);
    uint biases = naga_f2u32(_e1.z);
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        const float4 _e17 = irradia_constant((biases + i));
        irradia_units[i] = _e17;
    }
}

void irradia_push(uint column, float value)
{
    uint first = irradia_first_matrix.x + column;
    uint stride = irradia_first_matrix.y;
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        float4 _e17 = irradia_units[i];
        const float4 _e21 = irradia_constant((first + (i * stride)));
        irradia_units[i] = _e17 + (value * _e21);
    }
}

float4 irradia_row(uint weights, uint biases)
{
    float4 sum = (float4)0;
    uint at = (uint)0;

    const float4 _e2 = irradia_constant(biases);
    sum = _e2;
    at = weights;
    for (uint j = 0u; j < irradia_blocks; j += 1u) {
        float4 units = irradia_units[j];
        const float4 _e16 = irradia_constant(at);
        sum = sum + (_e16 * units.x);
        const float4 _e24 = irradia_constant((at + 1u));
        sum = sum + (_e24 * units.y);
        const float4 _e32 = irradia_constant((at + 2u));
        sum = sum + (_e32 * units.z);
        const float4 _e40 = irradia_constant((at + 3u));
        sum = sum + (_e40 * units.w);
        at = at + 4u;
    }
    return sum;
}

void irradia_hidden_layers()
{
    uint weights = (uint)0;

    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        float4 _e11 = irradia_units[i];
        const float4 _e12 = irradia_activation(_e11);
        irradia_units[i] = _e12;
    }
    const float4 _e17 = irradia_constant(1u);
    uint n_layers = naga_f2u32(_e17.w);
    const float4 _e21 = irradia_constant(2u);
    weights = naga_f2u32(_e21.w);
    for (uint layer = 1u; layer < n_layers; layer += 1u) {
        uint biases = weights + irradia_matrix;
        for (uint i_1 = 0u; i_1 < irradia_blocks; i_1 += 1u) {
            const float4 _e43 = irradia_row(weights, (biases + i_1));
            irradia_sums[i_1] = _e43;
            weights = weights + irradia_row_stride;
        }
        for (uint i_4 = 0u; i_4 < irradia_blocks; i_4 += 1u) {
            float4 _e61 = irradia_sums[i_4];
            const float4 _e62 = irradia_activation(_e61);
            irradia_units[i_4] = _e62;
        }
        weights = weights + irradia_blocks;
    }
}

float4 irradia_output(uint block)
{
    const float4 _e2 = irradia_constant(3u);
    const float4 _e11 = irradia_row((naga_f2u32(_e2.x) + (block * irradia_row_stride)), (naga_f2u32(_e2.y) + block));
    return _e11;
}
