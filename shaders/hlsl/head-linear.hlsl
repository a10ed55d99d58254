// Generated from shaders/wgsl/head-linear.wgsl by `npm run shaders` in web/: don't edit.

float3 irradia_head(float3 z)
{
    return z;
}

float3 irradia_head_unclamped(float3 z)
{
    return z;
}
