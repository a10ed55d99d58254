// Generated from shaders/wgsl/activation-gelu.wgsl by `npm run shaders` in web/: don't edit.

float4 irradia_activation(float4 z)
{
    float4 twice = 1.5957692 * (z + (((0.044715 * z) * z) * z));
    return z / ((1.0).xxxx + exp(min(-(twice), (80.0).xxxx)));
}
