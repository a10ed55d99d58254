// Generated from shaders/wgsl/perceptron-float.wgsl by `npm run shaders` in web/: don't edit.
// needs: constants, width, activation

uvec2 irradia_first_matrix;

void irradia_begin() {
    vec4 _e1 = irradia_constant(2u);
    irradia_first_matrix = uvec2(_e1.xy);
    uint biases = uint(_e1.z);
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        vec4 _e17 = irradia_constant((biases + i));
        irradia_units[i] = _e17;
    }
}

void irradia_push(uint column, float value) {
    uint first = irradia_first_matrix.x + column;
    uint stride = irradia_first_matrix.y;
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        vec4 _e17 = irradia_units[i];
        vec4 _e21 = irradia_constant((first + (i * stride)));
        irradia_units[i] = _e17 + (value * _e21);
    }
}

vec4 irradia_row(uint weights, uint biases) {
    vec4 sum = vec4(0.0);
    uint at = 0u;
    vec4 _e2 = irradia_constant(biases);
    sum = _e2;
    at = weights;
    for (uint j = 0u; j < irradia_blocks; j += 1u) {
        vec4 units = irradia_units[j];
        vec4 _e16 = irradia_constant(at);
        sum = sum + (_e16 * units.x);
        vec4 _e24 = irradia_constant((at + 1u));
        sum = sum + (_e24 * units.y);
        vec4 _e32 = irradia_constant((at + 2u));
        sum = sum + (_e32 * units.z);
        vec4 _e40 = irradia_constant((at + 3u));
        sum = sum + (_e40 * units.w);
        at = at + 4u;
    }
    return sum;
}

void irradia_hidden_layers() {
    uint weights = 0u;
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        vec4 _e11 = irradia_units[i];
        vec4 _e12 = irradia_activation(_e11);
        irradia_units[i] = _e12;
    }
    vec4 _e17 = irradia_constant(1u);
    uint n_layers = uint(_e17.w);
    vec4 _e21 = irradia_constant(2u);
    weights = uint(_e21.w);
    for (uint layer = 1u; layer < n_layers; layer += 1u) {
        uint biases = weights + irradia_matrix;
        for (uint i_1 = 0u; i_1 < irradia_blocks; i_1 += 1u) {
            vec4 _e43 = irradia_row(weights, (biases + i_1));
            irradia_sums[i_1] = _e43;
            weights = weights + irradia_row_stride;
        }
        for (uint i_4 = 0u; i_4 < irradia_blocks; i_4 += 1u) {
            vec4 _e61 = irradia_sums[i_4];
            vec4 _e62 = irradia_activation(_e61);
            irradia_units[i_4] = _e62;
        }
        weights = weights + irradia_blocks;
    }
}

vec4 irradia_output(uint block) {
    vec4 _e2 = irradia_constant(3u);
    vec4 _e11 = irradia_row((uint(_e2.x) + (block * irradia_row_stride)), (uint(_e2.y) + block));
    return _e11;
}
