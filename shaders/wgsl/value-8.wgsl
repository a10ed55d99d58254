// Values of a table that are signed bytes times a scale: how to sum weighted texels, and to hand the sums to the
// perceptron.
// needs: words, perceptron, scales

var<private> irradia_table_sums: array<vec4f, 4>;

fn irradia_table_clear() {
    for (var i = 0u; i < irradia_table_words; i++) {
        irradia_table_sums[i] = vec4f(0.0);
    }
}

// The scale of a block of codes.
fn irradia_table_scale(first: u32, block: u32) -> f32 {
    return irradia_scale(first + block);
}

fn irradia_table_add(words: vec4u, weight: f32) {
    for (var i = 0u; i < irradia_table_words; i++) {
        // Each byte to the top, then back down with its sign.
        let bytes = bitcast<vec4i>(vec4u(words[i]) << vec4u(24u, 16u, 8u, 0u)) >> vec4u(24u);
        irradia_table_sums[i] += weight * vec4f(bytes);
    }
}

// The first `count` sums, or all that a texel holds, as features from `column` on.
fn irradia_table_push(column: u32, count: u32) {
    for (var i = 0u; i < irradia_table_words; i++) {
        for (var j = 0u; j < 4u; j++) {
            let feature = 4u * i + j;
            if (feature < count) {
                irradia_push(column + feature, irradia_table_sums[i][j]);
            }
        }
    }
}
