// Generated from shaders/wgsl/sine.wgsl by `npm run shaders` in web/: don't edit.

vec4 irradia_sine_near(vec4 t) {
    vec4 s = t * t;
    return t * (vec4(3.1415925) + (s * (vec4(-5.167707) + (s * (vec4(2.5500314) + (s * (vec4(-0.5980452) + (s * 0.07722013))))))));
}

float irradia_sine_of_half_turns(float t) {
    float r = t - (2.0 * roundEven((0.5 * t)));
    float folded = (abs(r) > 0.5) ? (sign(r) - r) : r;
    vec4 _e14 = irradia_sine_near(vec4(folded));
    return _e14.x;
}

float irradia_cosine_of_half_turns(float t) {
    float r = t - (2.0 * roundEven((0.5 * t)));
    vec4 _e11 = irradia_sine_near(vec4((0.5 - abs(r))));
    return _e11.x;
}

vec4 irradia_sine(vec4 z) {
    vec4 n = roundEven((z * 0.31830987));
    vec4 r = ((z - (n * 3.140625)) - (n * 0.0009675026)) - (n * 1.509958e-7);
    vec4 isOdd = n - (2.0 * floor((0.5 * n)));
    vec4 _e26 = irradia_sine_near((r * 0.31830987));
    return (vec4(1.0) - (2.0 * isOdd)) * _e26;
}
