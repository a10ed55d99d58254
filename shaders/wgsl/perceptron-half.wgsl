// The perceptron in half precision: weights, and the units that one hidden layer hands to the next, are half floats;
// sums are floats. Errors of trained fields were at most 8.3e-4 of the largest value so; with products in halves,
// summed by fours, 1.4e-3, and with everything in halves 6.1e-3.
// Weights have a texture of their own, of 256 columns, a texel two columns of a block of 4 × 4. The blocks of the first
// matrix go by columns, so that a texel is one feature's column in two of them; those of others by rows.
// needs: constants, width, halves, activation
// enable: f16
// given: var irradia_weights: texture_2d_array<u32>

// Beyond it halves are infinite.
const irradia_largest_half: f32 = 65504.0;

// First texel of the first matrix.
var<private> irradia_first_matrix: u32;

// Before the first feature.
fn irradia_begin() {
    let layer = irradia_constant(2u);
    irradia_first_matrix = u32(layer.x);
    let biases = u32(layer.z);
    for (var i = 0u; i < irradia_blocks; i++) {
        irradia_units[i] = irradia_constant(biases + i);
    }
}

fn irradia_weights_at(texel: u32) -> vec4u {
    return textureLoad(irradia_weights, vec2u(texel & 255u, texel >> 8u), 0, 0);
}

fn irradia_four_halves(words: vec2u) -> vec4f {
    return vec4f(unpack2x16float(words.x), unpack2x16float(words.y));
}

// Feature number `column`.
fn irradia_push(column: u32, value: f32) {
    var texel = irradia_first_matrix + column * irradia_column_texels;
    for (var i = 0u; i < irradia_blocks; i += 2u) {
        let words = irradia_weights_at(texel);
        let next = i + 1u;
        irradia_units[i] += value * irradia_four_halves(words.xy);
        irradia_units[next] += value * irradia_four_halves(words.zw);
        texel += 1u;
    }
}

// A block's share in four sums; its columns are in two texels.
fn irradia_block_sum(texel: u32, units: vec4f) -> vec4f {
    let left = irradia_weights_at(texel);
    let right = irradia_weights_at(texel + 1u);
    return irradia_four_halves(left.xy) * units.x + irradia_four_halves(left.zw) * units.y
        + irradia_four_halves(right.xy) * units.z + irradia_four_halves(right.zw) * units.w;
}

// From the first layer's sums to the last hidden layer's units, which stay floats.
fn irradia_hidden_layers() {
    for (var i = 0u; i < irradia_blocks; i++) {
        irradia_units[i] = irradia_activation(irradia_units[i]);
    }
    let n_layers = u32(irradia_constant(1u).w);
    var texel = u32(irradia_constant(2u).w);
    var biases = u32(irradia_constant(2u).z);
    let largest = vec4f(irradia_largest_half);
    for (var layer = 1u; layer < n_layers; layer++) {
        biases += irradia_blocks;
        for (var i = 0u; i < irradia_blocks; i++) {
            irradia_halves[i] = vec4h(clamp(irradia_units[i], -largest, largest));
        }
        for (var i = 0u; i < irradia_blocks; i++) {
            var sum = irradia_constant(biases + i);
            for (var j = 0u; j < irradia_blocks; j++) {
                sum += irradia_block_sum(texel, vec4f(irradia_halves[j]));
                texel += 2u;
            }
            irradia_sums[i] = sum;
        }
        for (var i = 0u; i < irradia_blocks; i++) {
            irradia_units[i] = irradia_activation(irradia_sums[i]);
        }
    }
}

// Outputs 4 · block to 4 · block + 3, before the head.
fn irradia_output(block: u32) -> vec4f {
    let layer = irradia_constant(3u);
    var texel = u32(layer.x) + block * irradia_row_texels;
    var sum = irradia_constant(u32(layer.y) + block);
    for (var j = 0u; j < irradia_blocks; j++) {
        sum += irradia_block_sum(texel, irradia_units[j]);
        texel += 2u;
    }
    return sum;
}
