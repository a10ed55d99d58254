// Generated from shaders/wgsl/head-softplus.wgsl by `npm run shaders` in web/: don't edit.

float3 irradia_head(float3 z)
{
    float3 e = exp(-(abs(z)));
    return max(z, (0.0).xxx) + ((e < (0.001).xxx) ? (e - ((0.5 * e) * e)) : log(((1.0).xxx + e)));
}

float3 irradia_head_unclamped(float3 z)
{
    const float3 _e1 = irradia_head(z);
    return _e1;
}
