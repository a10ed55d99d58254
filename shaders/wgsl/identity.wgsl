// The coordinates themselves. Its record among the constants is the first feature's column.
// needs: perceptron

fn irradia_identity(record: u32, x: vec3f) {
    let column = u32(irradia_constant(record).x);
    irradia_push(column, x.x);
    irradia_push(column + 1u, x.y);
    irradia_push(column + 2u, x.z);
}
