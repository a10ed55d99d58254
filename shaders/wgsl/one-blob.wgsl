// How much of a bump of radius 1 / bins, centred on a coordinate, lies in each bin of [0, 1] (Müller et al. 2019,
// section 4.3, with tiny-cuda-nn's quartic). Its record among the constants: first feature's column, bins.
// needs: perceptron

// ∫ 15/16 (1 − u²)² from −1; 0 below and 1 above ±1.
fn irradia_blob_below(edge: f32) -> f32 {
    let u = clamp(edge, -1.0, 1.0);
    let s = u * u;
    return 0.5 + 0.9375 * u * (1.0 + s * (-0.6666666666666666 + 0.2 * s));
}

// Coordinate by coordinate, then by bin.
fn irradia_one_blob(record: u32, x: vec3f) {
    let shape = irradia_constant(record);
    var column = u32(shape.x);
    let n_bins = u32(shape.y);
    for (var axis = 0u; axis < 3u; axis++) {
        var edge = -x[axis] * shape.y;
        var below = irradia_blob_below(edge);
        for (var bin = 0u; bin < n_bins; bin++) {
            edge += 1.0;
            let above = irradia_blob_below(edge);
            irradia_push(column, above - below);
            below = above;
            column += 1u;
        }
    }
}
