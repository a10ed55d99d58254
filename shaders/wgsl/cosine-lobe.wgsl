// E on a surface from spherical harmonics of radiance: constants of the harmonics times those of the cosine lobe
// (π, 2π/3, π/4 by band; Ramamoorthi and Hanrahan 2001, equation 8). Order Y00, Y1-1 (y), Y10 (z), Y11 (x), and on.

// Weights of the first four coefficients.
fn irradia_lobe_linear(n: vec3f) -> vec4f {
    return vec4f(0.886226925452758, 1.0233267079464885 * n.yzx);
}

// Of the next four: xy, yz, 3z² − 1, xz.
fn irradia_lobe_quadratic(n: vec3f) -> vec4f {
    return vec4f(
        0.8580855308097834 * n.x * n.y,
        0.8580855308097834 * n.y * n.z,
        0.24770795610037571 * (3.0 * n.z * n.z - 1.0),
        0.8580855308097834 * n.x * n.z,
    );
}

// Of the ninth: x² − y².
fn irradia_lobe_squares(n: vec3f) -> f32 {
    return 0.4290427654048917 * (n.x * n.x - n.y * n.y);
}
