// Generated from shaders/wgsl/sine.wgsl by `npm run shaders` in web/: don't edit.

float4 irradia_sine_near(float4 t)
{
    float4 s = t * t;
    return t * ((3.1415925).xxxx + (s * ((-5.167707).xxxx + (s * ((2.5500314).xxxx + (s * ((-0.5980452).xxxx + (s * 0.07722013))))))));
}

float irradia_sine_of_half_turns(float t)
{
    float r = t - (2.0 * round((0.5 * t)));
    float folded = (abs(r) > 0.5) ? (sign(r) - r) : r;
    const float4 _e14 = irradia_sine_near((folded).xxxx);
    return _e14.x;
}

float irradia_cosine_of_half_turns(float t)
{
    float r = t - (2.0 * round((0.5 * t)));
    const float4 _e11 = irradia_sine_near(((0.5 - abs(r))).xxxx);
    return _e11.x;
}

float4 irradia_sine(float4 z)
{
    float4 n = round((z * 0.31830987));
    float4 r = ((z - (n * 3.140625)) - (n * 0.0009675026)) - (n * 1.509958e-7);
    float4 isOdd = n - (2.0 * floor((0.5 * n)));
    const float4 _e26 = irradia_sine_near((r * 0.31830987));
    return ((1.0).xxxx - (2.0 * isOdd)) * _e26;
}
