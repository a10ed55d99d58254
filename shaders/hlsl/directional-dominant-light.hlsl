// Generated from shaders/wgsl/directional-dominant-light.wgsl by `npm run shaders` in web/: don't edit.
// needs: directional-dominant
// given, in WGSL: fn irradia_lightmap_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_direction_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: var<uniform> irradia_map_scales: array<vec4f>

float3 irradia_light(float3 normal, float3 surface_normal, float2 lightmap_uv, float page)
{
    const float4 _e4 = irradia_lightmap_sample(lightmap_uv, page);
    float _e9 = irradia_map_scales[0].x;
    float3 plain = _e4.xyz * _e9;
    const float4 _e11 = irradia_direction_sample(lightmap_uv, page);
    float _e16 = irradia_map_scales[0].y;
    float3 coded = _e11.xyz * _e16;
    const float _e23 = irradia_dominant_share(((2.0 * coded) - (1.0).xxx), normal, surface_normal);
    return max((plain * _e23), (0.0).xxx);
}
