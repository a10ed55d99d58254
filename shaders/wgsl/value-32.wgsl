// Values of a table that are floats: how to sum weighted texels, and to hand the sums to the perceptron.
// needs: words, perceptron

var<private> irradia_table_sums: vec4f;

fn irradia_table_clear() {
    irradia_table_sums = vec4f(0.0);
}

// Floats need no scale.
fn irradia_table_scale(first: u32, block: u32) -> f32 {
    return 1.0;
}

fn irradia_table_add(words: vec4u, weight: f32) {
    irradia_table_sums += weight * bitcast<vec4f>(words);
}

// The first `count` sums, or all that a texel holds, as features from `column` on.
fn irradia_table_push(column: u32, count: u32) {
    for (var i = 0u; i < irradia_table_words; i++) {
        if (i < count) {
            irradia_push(column + i, irradia_table_sums[i]);
        }
    }
}
