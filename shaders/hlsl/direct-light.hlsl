// Generated from shaders/wgsl/direct-light.wgsl by `npm run shaders` in web/: don't edit.
// given, in WGSL: fn irradia_direct_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: var<uniform> irradia_direct_scale: array<vec4f>

float3 irradia_direct_light(float2 lightmap_uv, float page)
{
    const float4 _e2 = irradia_direct_sample(lightmap_uv, page);
    float3 texel = _e2.xyz;
    float _e7 = irradia_direct_scale[0].x;
    return max((texel * _e7), (0.0).xxx);
}
