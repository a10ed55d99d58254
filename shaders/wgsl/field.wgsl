// What all fields share: the box, the scale, and the way through the network. The first four of the constants are
//     0  the box's least corner, scale
//     1  the box's extent, number of hidden layers
//     2  first matrix: its first vec4, vec4s of a row of blocks, first bias; then the first vec4 of the second layer
//     3  last matrix: its first vec4, first bias
// needs: perceptron
// given: fn irradia_encode(unit: vec3f, normal: vec3f)

// A place in metres in [0, 1]³ of the box; what lies outside is clamped.
fn irradia_unit_position(position: vec3f) -> vec3f {
    let x = (position - irradia_constant(0u).xyz) / irradia_constant(1u).xyz;
    return clamp(x, vec3f(0.0), vec3f(1.0));
}

// Everything but the last layer. `irradia_encode` is made for each field: one call for each of its encodings.
fn irradia_run(position: vec3f, normal: vec3f) {
    irradia_begin();
    irradia_encode(irradia_unit_position(position), normal);
    irradia_hidden_layers();
}
