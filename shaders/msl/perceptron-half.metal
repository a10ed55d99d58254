// Generated from shaders/wgsl/perceptron-half.wgsl by `npm run shaders` in web/: don't edit.
// needs: constants, width, halves, activation
// given, in WGSL: var irradia_weights: texture_2d_array<u32>

uint irradia_first_matrix;

static constant constexpr const float irradia_largest_half = 65504.0;

void irradia_begin() {
    metal::float4 _e1 = irradia_constant(2u);
    irradia_first_matrix = naga_f2u32(_e1.x);
    uint biases = naga_f2u32(_e1.z);
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        metal::float4 _e17 = irradia_constant(biases + i);
        irradia_units[i] = _e17;
    }
}

metal::uint4 irradia_weights_at(
    uint texel
) {
    metal::uint4 _e9 = irradia_weights.read(metal::uint2(metal::uint2(texel & 255u, texel >> 8u)), 0, 0);
    return _e9;
}

metal::float4 irradia_four_halves(
    metal::uint2 words
) {
    return metal::float4(float2(as_type<half2>(words.x)), float2(as_type<half2>(words.y)));
}

void irradia_push(
    uint column,
    float value
) {
    uint texel = {};
    texel = irradia_first_matrix + (column * irradia_column_texels);
    for (uint i = 0u; i < irradia_blocks; i += 2u) {
        metal::uint4 _e14 = irradia_weights_at(texel);
        uint next = i + 1u;
        metal::float4 _e21 = irradia_units[i];
        metal::float4 _e23 = irradia_four_halves(_e14.xy);
        irradia_units[i] = _e21 + (value * _e23);
        metal::float4 _e28 = irradia_units[next];
        metal::float4 _e30 = irradia_four_halves(_e14.zw);
        irradia_units[next] = _e28 + (value * _e30);
        texel = texel + 1u;
    }
}

metal::float4 irradia_block_sum(
    uint texel,
    metal::float4 units
) {
    metal::uint4 _e2 = irradia_weights_at(texel);
    metal::uint4 _e5 = irradia_weights_at(texel + 1u);
    metal::float4 _e7 = irradia_four_halves(_e2.xy);
    metal::float4 _e11 = irradia_four_halves(_e2.zw);
    metal::float4 _e16 = irradia_four_halves(_e5.xy);
    metal::float4 _e21 = irradia_four_halves(_e5.zw);
    return (((_e7 * units.x) + (_e11 * units.y)) + (_e16 * units.z)) + (_e21 * units.w);
}

void irradia_hidden_layers() {
    uint texel = {};
    uint biases = {};
    metal::float4 sum = {};
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        metal::float4 _e11 = irradia_units[i];
        metal::float4 _e12 = irradia_activation(_e11);
        irradia_units[i] = _e12;
    }
    metal::float4 _e17 = irradia_constant(1u);
    uint n_layers = naga_f2u32(_e17.w);
    metal::float4 _e21 = irradia_constant(2u);
    texel = naga_f2u32(_e21.w);
    metal::float4 _e26 = irradia_constant(2u);
    biases = naga_f2u32(_e26.z);
    metal::float4 largest = metal::float4(65504.0);
    for (uint layer = 1u; layer < n_layers; layer += 1u) {
        biases = biases + irradia_blocks;
        for (uint i_1 = 0u; i_1 < irradia_blocks; i_1 += 1u) {
            irradia_halves[i_1] = static_cast<metal::half4>(metal::clamp(irradia_units[i_1], -(largest), largest));
        }
        for (uint i_4 = 0u; i_4 < irradia_blocks; i_4 += 1u) {
            metal::float4 _e65 = irradia_constant(biases + i_4);
            sum = _e65;
            for (uint j = 0u; j < irradia_blocks; j += 1u) {
                metal::half4 _e77 = irradia_halves[j];
                metal::float4 _e79 = irradia_block_sum(texel, static_cast<metal::float4>(_e77));
                sum = sum + _e79;
                texel = texel + 2u;
            }
            irradia_sums[i_4] = sum;
        }
        for (uint i_5 = 0u; i_5 < irradia_blocks; i_5 += 1u) {
            metal::float4 _e105 = irradia_sums[i_5];
            metal::float4 _e106 = irradia_activation(_e105);
            irradia_units[i_5] = _e106;
        }
    }
}

metal::float4 irradia_output(
    uint block
) {
    uint texel = {};
    metal::float4 sum = {};
    metal::float4 _e2 = irradia_constant(3u);
    texel = naga_f2u32(_e2.x) + (block * irradia_row_texels);
    metal::float4 _e12 = irradia_constant(naga_f2u32(_e2.y) + block);
    sum = _e12;
    for (uint j = 0u; j < irradia_blocks; j += 1u) {
        metal::float4 _e24 = irradia_units[j];
        metal::float4 _e25 = irradia_block_sum(texel, _e24);
        sum = sum + _e25;
        texel = texel + 2u;
    }
    return sum;
}
