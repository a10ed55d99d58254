// Values of a table that are nibbles, 8 above codes, times a scale: how to sum weighted texels, and to hand the sums to
// the perceptron.
// needs: words, perceptron, scales

// Of the lower and upper four nibbles of each word.
var<private> irradia_table_lower: array<vec4f, 4>;
var<private> irradia_table_upper: array<vec4f, 4>;

fn irradia_table_clear() {
    for (var i = 0u; i < irradia_table_words; i++) {
        irradia_table_lower[i] = vec4f(0.0);
        irradia_table_upper[i] = vec4f(0.0);
    }
}

// The scale of a block of codes.
fn irradia_table_scale(first: u32, block: u32) -> f32 {
    return irradia_scale(first + block);
}

fn irradia_table_add(words: vec4u, weight: f32) {
    for (var i = 0u; i < irradia_table_words; i++) {
        let lower = (vec4u(words[i]) >> vec4u(0u, 4u, 8u, 12u)) & vec4u(15u);
        let upper = (vec4u(words[i]) >> vec4u(16u, 20u, 24u, 28u)) & vec4u(15u);
        irradia_table_lower[i] += weight * (vec4f(lower) - 8.0);
        irradia_table_upper[i] += weight * (vec4f(upper) - 8.0);
    }
}

// The first `count` sums, or all that a texel holds, as features from `column` on.
fn irradia_table_push(column: u32, count: u32) {
    for (var i = 0u; i < irradia_table_words; i++) {
        for (var j = 0u; j < 4u; j++) {
            let feature = 8u * i + j;
            if (feature < count) {
                irradia_push(column + feature, irradia_table_lower[i][j]);
            }
            if (feature + 4u < count) {
                irradia_push(column + feature + 4u, irradia_table_upper[i][j]);
            }
        }
    }
}
