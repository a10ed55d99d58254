// Values of a table that are half floats: how to sum weighted texels, and to hand the sums to the perceptron.
// needs: words, perceptron

var<private> irradia_table_sums: array<vec2f, 4>;

fn irradia_table_clear() {
    for (var i = 0u; i < irradia_table_words; i++) {
        irradia_table_sums[i] = vec2f(0.0);
    }
}

// Half floats need no scale.
fn irradia_table_scale(first: u32, block: u32) -> f32 {
    return 1.0;
}

fn irradia_table_add(words: vec4u, weight: f32) {
    for (var i = 0u; i < irradia_table_words; i++) {
        irradia_table_sums[i] += weight * unpack2x16float(words[i]);
    }
}

// The first `count` sums, or all that a texel holds, as features from `column` on.
fn irradia_table_push(column: u32, count: u32) {
    for (var i = 0u; i < irradia_table_words; i++) {
        let first = 2u * i;
        if (first < count) {
            irradia_push(column + first, irradia_table_sums[i].x);
        }
        if (first + 1u < count) {
            irradia_push(column + first + 1u, irradia_table_sums[i].y);
        }
    }
}
