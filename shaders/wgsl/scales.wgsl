// Scales of codes: single floats among the constants.
// needs: constants

fn irradia_scale(at: u32) -> f32 {
    return irradia_constant(at >> 2u)[at & 3u];
}
