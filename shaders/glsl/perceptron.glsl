// Generated from shaders/wgsl/perceptron.wgsl by `npm run shaders` in web/: don't edit.
// needs: constants, width, activation

uvec2 irradia_first_matrix = uvec2(0u);

void irradia_begin() {
    vec4 _e1 = irradia_constant(2u);
    irradia_first_matrix = uvec2(_e1.xy);
    uint biases = uint(_e1.z);
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        uint _e13 = i;
        uint _e15 = i;
        vec4 _e17 = irradia_constant((biases + _e15));
        irradia_units[_e13] = _e17;
    }
    return;
}

void irradia_push(uint column, float value) {
    uint _e4 = irradia_first_matrix.x;
    uint first = (_e4 + column);
    uint stride = irradia_first_matrix.y;
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        uint _e15 = i;
        vec4 _e17 = irradia_units[_e15];
        uint _e18 = i;
        vec4 _e21 = irradia_constant((first + (_e18 * stride)));
        irradia_units[_e15] = (_e17 + (value * _e21));
    }
    return;
}

vec4 irradia_row(uint weights, uint biases) {
    vec4 sum = vec4(0.0);
    uint at = 0u;
    vec4 _e2 = irradia_constant(biases);
    sum = _e2;
    at = weights;
    for (uint j = 0u; j < irradia_blocks; j += 1u) {
        uint _e11 = j;
        vec4 units = irradia_units[_e11];
        vec4 _e14 = sum;
        uint _e15 = at;
        vec4 _e16 = irradia_constant(_e15);
        sum = (_e14 + (_e16 * units.x));
        vec4 _e20 = sum;
        uint _e21 = at;
        vec4 _e24 = irradia_constant((_e21 + 1u));
        sum = (_e20 + (_e24 * units.y));
        vec4 _e28 = sum;
        uint _e29 = at;
        vec4 _e32 = irradia_constant((_e29 + 2u));
        sum = (_e28 + (_e32 * units.z));
        vec4 _e36 = sum;
        uint _e37 = at;
        vec4 _e40 = irradia_constant((_e37 + 3u));
        sum = (_e36 + (_e40 * units.w));
        uint _e44 = at;
        at = (_e44 + 4u);
    }
    vec4 _e50 = sum;
    return _e50;
}

void irradia_hidden_layers() {
    uint weights = 0u;
    for (uint i = 0u; i < irradia_blocks; i += 1u) {
        uint _e6 = i;
        uint _e9 = i;
        vec4 _e11 = irradia_units[_e9];
        vec4 _e12 = irradia_activation(_e11);
        irradia_units[_e6] = _e12;
    }
    vec4 _e17 = irradia_constant(1u);
    uint n_layers = uint(_e17.w);
    vec4 _e21 = irradia_constant(2u);
    weights = uint(_e21.w);
    for (uint layer = 1u; layer < n_layers; layer += 1u) {
        uint _e29 = weights;
        uint biases = (_e29 + irradia_matrix);
        for (uint i_1 = 0u; i_1 < irradia_blocks; i_1 += 1u) {
            uint _e38 = i_1;
            uint _e40 = weights;
            uint _e41 = i_1;
            vec4 _e43 = irradia_row(_e40, (biases + _e41));
            irradia_sums[_e38] = _e43;
            uint _e44 = weights;
            weights = (_e44 + irradia_row_stride);
        }
        for (uint i_4 = 0u; i_4 < irradia_blocks; i_4 += 1u) {
            uint _e56 = i_4;
            uint _e59 = i_4;
            vec4 _e61 = irradia_sums[_e59];
            vec4 _e62 = irradia_activation(_e61);
            irradia_units[_e56] = _e62;
        }
        uint _e66 = weights;
        weights = (_e66 + irradia_blocks);
    }
    return;
}

vec4 irradia_output(uint block) {
    vec4 _e2 = irradia_constant(3u);
    vec4 _e11 = irradia_row((uint(_e2.x) + (block * irradia_row_stride)), (uint(_e2.y) + block));
    return _e11;
}
