// Generated from shaders/wgsl/activation-silu.wgsl by `npm run shaders` in web/: don't edit.

float4 irradia_activation(float4 z)
{
    return z / ((1.0).xxxx + exp(min(-(z), (80.0).xxxx)));
}
