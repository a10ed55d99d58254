// Generated from shaders/wgsl/directional-rnm-light.wgsl by `npm run shaders` in web/: don't edit.
// needs: directional-rnm
// given, in WGSL: fn irradia_rnm_a_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_rnm_b_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: fn irradia_rnm_c_sample(uv: vec2f, layer: f32) -> vec4f
// given, in WGSL: var<uniform> irradia_map_scales: array<vec4f>

metal::float3 irradia_light(
    metal::float3 normal,
    metal::float3 surface_normal,
    metal::float4 tangent,
    metal::float2 lightmap_uv,
    float page
) {
    metal::float3 _e5 = irradia_rnm_weights(normal, surface_normal, tangent);
    metal::float3 weights = _e5 * irradia_map_scales[0].xyz;
    metal::float4 _e11 = irradia_rnm_a_sample(lightmap_uv, page);
    metal::float3 a = _e11.xyz;
    metal::float4 _e13 = irradia_rnm_b_sample(lightmap_uv, page);
    metal::float3 b = _e13.xyz;
    metal::float4 _e15 = irradia_rnm_c_sample(lightmap_uv, page);
    metal::float3 c = _e15.xyz;
    return metal::max(((weights.x * a) + (weights.y * b)) + (weights.z * c), metal::float3(0.0));
}
