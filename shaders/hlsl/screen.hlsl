// Generated from shaders/wgsl/screen.wgsl by `npm run shaders` in web/: don't edit.
// needs: screen-surface
// given, in WGSL: var irradia_screen_prepass: texture_2d<f32>
// given, in WGSL: var<uniform> irradia_screen_view: array<vec4f>
// given, in WGSL: fn irradia_screen_light(position: vec3f, normal: vec3f, surface_normal: vec3f) -> vec3f

irradia_screen_Surface irradia_screen_seen(uint2 pixel)
{
    float4 _e3 = irradia_screen_prepass.Load(int3(pixel, int(0)));
    const irradia_screen_Surface _e4 = irradia_screen_unpacked(_e3);
    const irradia_screen_Surface irradia_screen_surface_1 = _e4;
    return irradia_screen_surface_1;
}

float3 irradia_screen_place(uint2 pixel, float depth)
{
    float2 slope = irradia_screen_view[0].xy + (float2(pixel) * irradia_screen_view[0].zw);
    float _e16 = irradia_screen_view[1].x;
    float2 across = slope * lerp(depth, 1.0, _e16);
    return (((irradia_screen_view[2].xyz * across.x) + (irradia_screen_view[3].xyz * across.y)) - (irradia_screen_view[4].xyz * depth)) + irradia_screen_view[5].xyz;
}

uint2 irradia_screen_sample(uint2 cell)
{
    return min((2u * cell), (naga_f2u32(irradia_screen_view[1].zw) - uint2(1u, 1u)));
}

float3 irradia_screen_irradiance(uint2 pixel)
{
    const irradia_screen_Surface _e1 = irradia_screen_seen(pixel);
    if (_e1.depth <= 0.0) {
        return (0.0).xxx;
    }
    const float3 _e8 = irradia_screen_place(pixel, _e1.depth);
    const float3 _e11 = irradia_screen_light(_e8, _e1.normal, _e1.surface_normal);
    return _e11;
}
