// The perceptron, in floats. Encodings push their features one by one into the first layer's sums, so there is no array of
// features, and a field may have any number of them. Matrices lie in blocks of 4 × 4, a vec4 a column; those of hidden
// layers follow one another, each before its biases.
// needs: constants, width, activation

// Of the first matrix: its first vec4, and vec4s from one row of blocks to the next.
var<private> irradia_first_matrix: vec2u;

// Before the first feature.
fn irradia_begin() {
    let layer = irradia_constant(2u);
    irradia_first_matrix = vec2u(layer.xy);
    let biases = u32(layer.z);
    for (var i = 0u; i < irradia_blocks; i++) {
        irradia_units[i] = irradia_constant(biases + i);
    }
}

// Feature number `column`.
fn irradia_push(column: u32, value: f32) {
    let first = irradia_first_matrix.x + column;
    let stride = irradia_first_matrix.y;
    for (var i = 0u; i < irradia_blocks; i++) {
        irradia_units[i] += value * irradia_constant(first + i * stride);
    }
}

// Four sums over all units of the layer before: a row of blocks from `weights` on, and the biases at `biases`.
fn irradia_row(weights: u32, biases: u32) -> vec4f {
    var sum = irradia_constant(biases);
    var at = weights;
    for (var j = 0u; j < irradia_blocks; j++) {
        let units = irradia_units[j];
        sum += irradia_constant(at) * units.x;
        sum += irradia_constant(at + 1u) * units.y;
        sum += irradia_constant(at + 2u) * units.z;
        sum += irradia_constant(at + 3u) * units.w;
        at += 4u;
    }
    return sum;
}

// From the first layer's sums to the last hidden layer's units. Sums are stored at an index that only a loop knows,
// and read back at fixed ones: so what the inner loop reads can stay in registers.
fn irradia_hidden_layers() {
    for (var i = 0u; i < irradia_blocks; i++) {
        irradia_units[i] = irradia_activation(irradia_units[i]);
    }
    let n_layers = u32(irradia_constant(1u).w);
    var weights = u32(irradia_constant(2u).w);
    for (var layer = 1u; layer < n_layers; layer++) {
        let biases = weights + irradia_matrix;
        for (var i = 0u; i < irradia_blocks; i++) {
            irradia_sums[i] = irradia_row(weights, biases + i);
            weights += irradia_row_stride;
        }
        for (var i = 0u; i < irradia_blocks; i++) {
            irradia_units[i] = irradia_activation(irradia_sums[i]);
        }
        weights += irradia_blocks;
    }
}

// Outputs 4 · block to 4 · block + 3, before the head.
fn irradia_output(block: u32) -> vec4f {
    let layer = irradia_constant(3u);
    return irradia_row(u32(layer.x) + block * irradia_row_stride, u32(layer.y) + block);
}
