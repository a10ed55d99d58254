// Generated from shaders/wgsl/activation-relu.wgsl by `npm run shaders` in web/: don't edit.

float4 irradia_activation(float4 z)
{
    return max(z, (0.0).xxxx);
}
