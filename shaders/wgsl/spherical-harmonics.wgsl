// Y_lm of the direction 2x − 1, real, every constant positive, by l and then m from −l to l. Its record among the
// constants: first feature's column, bands; then for each m from 0, and each l from m, a vec4: Y's constant for ±m, and
// a, b and c of the Legendre recurrence P_l = a z P_(l−1) − b P_(l−2) + c. The first of each m has a = b = 0, c = 1, so
// the constant takes in what P_m^m lacks.
// needs: perceptron

fn irradia_spherical_harmonics(record: u32, unit: vec3f) {
    let shape = vec2u(irradia_constant(record).xy);
    let v = 2.0 * unit - 1.0;
    // cos mφ and sin mφ, times sin^m θ.
    var turn = vec2f(1.0, 0.0);
    var at = record + 1u;
    for (var m = 0u; m < shape.y; m++) {
        var before = 0.0;
        var last = 0.0;
        for (var l = m; l < shape.y; l++) {
            let step = irradia_constant(at);
            let next = step.y * v.z * last - step.z * before + step.w;
            let centre = shape.x + l * (l + 1u);
            irradia_push(centre + m, step.x * next * turn.x);
            if (m > 0u) {
                irradia_push(centre - m, step.x * next * turn.y);
            }
            before = last;
            last = next;
            at += 1u;
        }
        turn = vec2f(v.x * turn.x - v.y * turn.y, v.x * turn.y + v.y * turn.x);
    }
}
