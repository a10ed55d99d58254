// Generated from shaders/wgsl/shadow-mask.wgsl by `npm run shaders` in web/: don't edit.

float irradia_shadow(float4 mask, int channel)
{
    int4 lights = int4(int(0), int(1), int(2), int(3));
    float4 own = (lights == (channel).xxxx) ? mask : (0.0).xxxx;
    return (channel < int(0)) ? 1.0 : (((own.x + own.y) + own.z) + own.w);
}
