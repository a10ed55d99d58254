// Generated from shaders/wgsl/screen.wgsl by `npm run shaders` in web/: don't edit.
// needs: screen-surface
// given, in WGSL: var irradia_screen_prepass: texture_2d<f32>
// given, in WGSL: var<uniform> irradia_screen_view: array<vec4f>
// given, in WGSL: fn irradia_screen_light(position: vec3f, normal: vec3f, surface_normal: vec3f) -> vec3f

irradia_screen_Surface irradia_screen_seen(
    metal::uint2 pixel
) {
    metal::float4 _e3 = irradia_screen_prepass.read(metal::uint2(pixel), 0);
    irradia_screen_Surface _e4 = irradia_screen_unpacked(_e3);
    return _e4;
}

metal::float3 irradia_screen_place(
    metal::uint2 pixel,
    float depth
) {
    metal::float2 slope = irradia_screen_view[0].xy + (static_cast<metal::float2>(pixel) * irradia_screen_view[0].zw);
    float _e16 = irradia_screen_view[1].x;
    metal::float2 across = slope * metal::mix(depth, 1.0, _e16);
    return (((irradia_screen_view[2].xyz * across.x) + (irradia_screen_view[3].xyz * across.y)) - (irradia_screen_view[4].xyz * depth)) + irradia_screen_view[5].xyz;
}

metal::uint2 irradia_screen_sample(
    metal::uint2 cell
) {
    return metal::min(2u * cell, naga_f2u32(irradia_screen_view[1].zw) - metal::uint2(1u, 1u));
}

metal::float3 irradia_screen_irradiance(
    metal::uint2 pixel
) {
    irradia_screen_Surface _e1 = irradia_screen_seen(pixel);
    if (_e1.depth <= 0.0) {
        return metal::float3(0.0);
    }
    metal::float3 _e8 = irradia_screen_place(pixel, _e1.depth);
    metal::float3 _e11 = irradia_screen_light(_e8, _e1.normal, _e1.surface_normal);
    return _e11;
}
