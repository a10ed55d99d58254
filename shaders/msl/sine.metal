// Generated from shaders/wgsl/sine.wgsl by `npm run shaders` in web/: don't edit.

metal::float4 irradia_sine_near(
    metal::float4 t
) {
    metal::float4 s = t * t;
    return t * (metal::float4(3.1415925) + (s * (metal::float4(-5.167707) + (s * (metal::float4(2.5500314) + (s * (metal::float4(-0.5980452) + (s * 0.07722013))))))));
}

float irradia_sine_of_half_turns(
    float t
) {
    float r = t - (2.0 * metal::rint(0.5 * t));
    float folded = (metal::abs(r) > 0.5) ? (metal::sign(r) - r) : r;
    metal::float4 _e14 = irradia_sine_near(metal::float4(folded));
    return _e14.x;
}

float irradia_cosine_of_half_turns(
    float t
) {
    float r = t - (2.0 * metal::rint(0.5 * t));
    metal::float4 _e11 = irradia_sine_near(metal::float4(0.5 - metal::abs(r)));
    return _e11.x;
}

metal::float4 irradia_sine(
    metal::float4 z
) {
    metal::float4 n = metal::rint(z * 0.31830987);
    metal::float4 r = ((z - (n * 3.140625)) - (n * 0.0009675026)) - (n * 0.0000001509958);
    metal::float4 isOdd = n - (2.0 * metal::floor(0.5 * n));
    metal::float4 _e26 = irradia_sine_near(r * 0.31830987);
    return (metal::float4(1.0) - (2.0 * isOdd)) * _e26;
}
