// Generated from shaders/wgsl/directional-sh-light.wgsl by `npm run shaders` in web/: don't edit.
// needs: directional-sh
// given, in WGSL: fn irradia_sh_mean_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_sh_x_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_sh_y_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_sh_z_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: var<uniform> irradia_map_scales: array<vec4f>

metal::float3 irradia_light(
    metal::float3 normal,
    metal::float3 surface_normal,
    metal::float2 lightmap_uv,
    float page
) {
    metal::float4 scales = irradia_map_scales[0];
    metal::float4 _e7 = irradia_sh_mean_sample(lightmap_uv, page);
    metal::float3 mean = _e7.xyz * scales.x;
    metal::float4 _e14 = irradia_sh_x_sample(lightmap_uv, page);
    metal::float3 x_1 = ((2.0 * scales.y) * _e14.xyz) - metal::float3(1.0);
    metal::float4 _e23 = irradia_sh_y_sample(lightmap_uv, page);
    metal::float3 y_1 = ((2.0 * scales.z) * _e23.xyz) - metal::float3(1.0);
    metal::float4 _e32 = irradia_sh_z_sample(lightmap_uv, page);
    metal::float3 z_1 = ((2.0 * scales.w) * _e32.xyz) - metal::float3(1.0);
    metal::float3 _e38 = irradia_sh_lobes(x_1, y_1, z_1, normal, surface_normal);
    return mean * _e38;
}
