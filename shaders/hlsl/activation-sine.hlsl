// Generated from shaders/wgsl/activation-sine.wgsl by `npm run shaders` in web/: don't edit.
// needs: sine

float4 irradia_activation(float4 z)
{
    const float4 _e1 = irradia_sine(z);
    return _e1;
}
