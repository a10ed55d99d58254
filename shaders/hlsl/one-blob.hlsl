// Generated from shaders/wgsl/one-blob.wgsl by `npm run shaders` in web/: don't edit.
// needs: perceptron

float irradia_blob_below(float edge)
{
    float u = clamp(edge, -1.0, 1.0);
    float s = (u * u);
    return (0.5 + ((0.9375 * u) * (1.0 + (s * (-0.6666667 + (0.2 * s))))));
}

void irradia_one_blob(uint record, float3 x)
{
    uint column = (uint)0;
    float edge = (float)0;
    float below = (float)0;

    const float4 _e2 = irradia_constant(record);
    column = naga_f2u32(_e2.x);
    uint n_bins = naga_f2u32(_e2.y);
    for (uint axis = 0u; axis < 3u; axis += 1u) {
        uint _e13 = axis;
        edge = (-(x[_e13]) * _e2.y);
        float _e19 = edge;
        const float _e20 = irradia_blob_below(_e19);
        below = _e20;
        for (uint bin = 0u; bin < n_bins; bin += 1u) {
            float _e26 = edge;
            edge = (_e26 + 1.0);
            float _e29 = edge;
            const float _e30 = irradia_blob_below(_e29);
            uint _e31 = column;
            float _e32 = below;
            irradia_push(_e31, (_e30 - _e32));
            below = _e30;
            uint _e34 = column;
            column = (_e34 + 1u);
        }
    }
    return;
}
