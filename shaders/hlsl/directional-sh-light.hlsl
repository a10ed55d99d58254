// Generated from shaders/wgsl/directional-sh-light.wgsl by `npm run shaders` in web/: don't edit.
// needs: directional-sh
// given, in WGSL: fn irradia_sh_mean_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_sh_x_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_sh_y_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_sh_z_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: var<uniform> irradia_map_scales: array<vec4f>

float3 irradia_light(float3 normal, float3 surface_normal, float2 lightmap_uv, float page)
{
    float4 scales = irradia_map_scales[0];
    const float4 _e7 = irradia_sh_mean_sample(lightmap_uv, page);
    float3 mean = _e7.xyz * scales.x;
    const float4 _e14 = irradia_sh_x_sample(lightmap_uv, page);
    float3 x_1 = ((2.0 * scales.y) * _e14.xyz) - (1.0).xxx;
    const float4 _e23 = irradia_sh_y_sample(lightmap_uv, page);
    float3 y_1 = ((2.0 * scales.z) * _e23.xyz) - (1.0).xxx;
    const float4 _e32 = irradia_sh_z_sample(lightmap_uv, page);
    float3 z_1 = ((2.0 * scales.w) * _e32.xyz) - (1.0).xxx;
    const float3 _e38 = irradia_sh_lobes(x_1, y_1, z_1, normal, surface_normal);
    return mean * _e38;
}
