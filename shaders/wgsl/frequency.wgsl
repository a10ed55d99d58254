// sin and cos of 2ᵏ · π · x, coordinate by coordinate, then by k (Mildenhall et al. 2020, equation 4). Its record among
// the constants: first feature's column, frequencies, 1 where the coordinates come before all of them.
// needs: perceptron, sine

fn irradia_frequency(record: u32, x: vec3f) {
    let shape = vec3u(irradia_constant(record).xyz);
    var column = shape.x;
    if (shape.z == 1u) {
        for (var axis = 0u; axis < 3u; axis++) {
            irradia_push(column + axis, x[axis]);
        }
        column += 3u;
    }
    for (var axis = 0u; axis < 3u; axis++) {
        // Doubling is exact, so a multiple of π is reduced before π ever enters.
        var half_turns = x[axis];
        for (var k = 0u; k < shape.y; k++) {
            irradia_push(column, irradia_sine_of_half_turns(half_turns));
            irradia_push(column + 1u, irradia_cosine_of_half_turns(half_turns));
            half_turns *= 2.0;
            column += 2u;
        }
    }
}
