// Generated from shaders/wgsl/perceptron-half.wgsl by `npm run shaders` in web/: don't edit.
// needs: constants, width, halves, activation
// given, in WGSL: var irradia_weights: texture_2d_array<u32>

static const float irradia_largest_half = 65504.0;

static uint irradia_first_matrix;

void irradia_begin()
{
    const float4 _e1 = irradia_constant(2u);
    irradia_first_matrix = naga_f2u32(_e1.x);
    uint biases = naga_f2u32(_e1.z);
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        const float4 _e17 = irradia_constant((biases + i));
        irradia_units[i] = _e17;
    }
}

uint4 irradia_weights_at(uint texel)
{
    uint4 _e9 = irradia_weights.Load(int4(uint2((texel & 255u), (texel >> 8u)), int(0), int(0)));
    return _e9;
}

float4 irradia_four_halves(uint2 words)
{
    return float4(float2(f16tof32(words.x), f16tof32((words.x) >> 16)), float2(f16tof32(words.y), f16tof32((words.y) >> 16)));
}

void irradia_push(uint column, float value)
{
    uint texel = (uint)0;

    texel = irradia_first_matrix + (column * irradia_column_texels);
    for (uint i = 0u; i < irradia_blocks; i += 2u) {
        const uint4 _e14 = irradia_weights_at(texel);
        uint next = i + 1u;
        float4 _e21 = irradia_units[i];
        const float4 _e23 = irradia_four_halves(_e14.xy);
        irradia_units[i] = _e21 + (value * _e23);
        float4 _e28 = irradia_units[next];
        const float4 _e30 = irradia_four_halves(_e14.zw);
        irradia_units[next] = _e28 + (value * _e30);
        texel = texel + 1u;
    }
}

float4 irradia_block_sum(uint texel, float4 units)
{
    const uint4 _e2 = irradia_weights_at(texel);
    const uint4 _e5 = irradia_weights_at((texel + 1u));
    const float4 _e7 = irradia_four_halves(_e2.xy);
    const float4 _e11 = irradia_four_halves(_e2.zw);
    const float4 _e16 = irradia_four_halves(_e5.xy);
    const float4 _e21 = irradia_four_halves(_e5.zw);
    return (((_e7 * units.x) + (_e11 * units.y)) + (_e16 * units.z)) + (_e21 * units.w);
}

void irradia_hidden_layers()
{
    uint texel = (uint)0;
    uint biases = (uint)0;
    float4 sum = (float4)0;

    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        float4 _e11 = irradia_units[i];
        const float4 _e12 = irradia_activation(_e11);
        irradia_units[i] = _e12;
    }
    const float4 _e17 = irradia_constant(1u);
    uint n_layers = naga_f2u32(_e17.w);
    const float4 _e21 = irradia_constant(2u);
    texel = naga_f2u32(_e21.w);
    const float4 _e26 = irradia_constant(2u);
    biases = naga_f2u32(_e26.z);
    float4 largest = (65504.0).xxxx;
    for (uint layer = 1u; layer < n_layers; layer += 1u) {
        biases = biases + irradia_blocks;
        for (uint i_1 = 0u; i_1 < irradia_blocks; i_1 += 1u) {
            irradia_halves[i_1] = half4(clamp(irradia_units[i_1], -(largest), largest));
        }
        for (uint i_4 = 0u; i_4 < irradia_blocks; i_4 += 1u) {
            const float4 _e65 = irradia_constant((biases + i_4));
            sum = _e65;
            for (uint j = 0u; j < irradia_blocks; j += 1u) {
                half4 _e77 = irradia_halves[j];
                const float4 _e79 = irradia_block_sum(texel, float4(_e77));
                sum = sum + _e79;
                texel = texel + 2u;
            }
            irradia_sums[i_4] = sum;
        }
        for (uint i_5 = 0u; i_5 < irradia_blocks; i_5 += 1u) {
            float4 _e105 = irradia_sums[i_5];
            const float4 _e106 = irradia_activation(_e105);
            irradia_units[i_5] = _e106;
        }
    }
}

float4 irradia_output(uint block)
{
    uint texel = (uint)0;
    float4 sum = (float4)0;

    const float4 _e2 = irradia_constant(3u);
    texel = naga_f2u32(_e2.x) + (block * irradia_row_texels);
    const float4 _e12 = irradia_constant((naga_f2u32(_e2.y) + block));
    sum = _e12;
    for (uint j = 0u; j < irradia_blocks; j += 1u) {
        float4 _e24 = irradia_units[j];
        const float4 _e25 = irradia_block_sum(texel, _e24);
        sum = sum + _e25;
        texel = texel + 2u;
    }
    return sum;
}
