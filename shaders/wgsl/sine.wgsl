// Sines and cosines with a range reduction and a polynomial of our own. WGSL promises an error of 2⁻¹¹ within ±π and
// nothing beyond, and processors make use of that; here it is below 3e-7 everywhere.

// sin(π t) for |t| ≤ ½: an odd polynomial, minimax.
fn irradia_sine_near(t: vec4f) -> vec4f {
    let s = t * t;
    return t * (3.14159258 + s * (-5.16770688 + s * (2.55003138 + s * (-0.598045174 + s * 0.0772201271))));
}

// sin(π t) of one number. Taking the nearest even number away is exact, so large t lose nothing.
fn irradia_sine_of_half_turns(t: f32) -> f32 {
    let r = t - 2.0 * round(0.5 * t);
    // sin(π r) = sin(π (1 − r))
    let folded = select(r, sign(r) - r, abs(r) > 0.5);
    return irradia_sine_near(vec4f(folded)).x;
}

// cos(π t) of one number.
fn irradia_cosine_of_half_turns(t: f32) -> f32 {
    let r = t - 2.0 * round(0.5 * t);
    return irradia_sine_near(vec4f(0.5 - abs(r))).x;
}

// sin(z), z in radians. π is taken away in three parts, of which the first two have few bits: their products with
// a half turn's number are exact (Cody and Waite 1980).
fn irradia_sine(z: vec4f) -> vec4f {
    let n = round(z * 0.3183098861837907);
    let r = ((z - n * 3.140625) - n * 0.0009675025939941406) - n * 1.5099580252808664e-7;
    let isOdd = n - 2.0 * floor(0.5 * n);
    return (1.0 - 2.0 * isOdd) * irradia_sine_near(r * 0.3183098861837907);
}
