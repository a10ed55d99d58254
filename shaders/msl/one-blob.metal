// Generated from shaders/wgsl/one-blob.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron

float irradia_blob_below(
    float edge
) {
    float u = metal::clamp(edge, -1.0, 1.0);
    float s = u * u;
    return 0.5 + ((0.9375 * u) * (1.0 + (s * (-0.6666667 + (0.2 * s)))));
}

void irradia_one_blob(
    uint record,
    metal::float3 x
) {
    uint column = {};
    float edge = {};
    float below = {};
    metal::float4 _e2 = irradia_constant(record);
    column = naga_f2u32(_e2.x);
    uint n_bins = naga_f2u32(_e2.y);
    for (uint axis = 0u; axis < 3u; axis += 1u) {
        edge = -(x[axis]) * _e2.y;
        float _e20 = irradia_blob_below(edge);
        below = _e20;
        for (uint bin = 0u; bin < n_bins; bin += 1u) {
            edge = edge + 1.0;
            float _e30 = irradia_blob_below(edge);
            irradia_push(column, _e30 - below);
            below = _e30;
            column = column + 1u;
        }
    }
}
