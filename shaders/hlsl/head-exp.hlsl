// Generated from shaders/wgsl/head-exp.wgsl by `npm run shaders` in web/: don't edit.

float3 irradia_head(float3 z)
{
    return exp(clamp(z, (-15.0).xxx, (15.0).xxx));
}

float3 irradia_head_unclamped(float3 z)
{
    return exp(z);
}
