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
    float4 _e4 = irradia_screen_view[0];
    float4 _e9 = irradia_screen_view[0];
    float2 slope = (_e4.xy + (float2(pixel) * _e9.zw));
    float _e16 = irradia_screen_view[1].x;
    float2 across = (slope * lerp(depth, 1.0, _e16));
    float4 _e22 = irradia_screen_view[2];
    float4 _e28 = irradia_screen_view[3];
    float4 _e35 = irradia_screen_view[4];
    float4 _e41 = irradia_screen_view[5];
    return ((((_e22.xyz * across.x) + (_e28.xyz * across.y)) - (_e35.xyz * depth)) + _e41.xyz);
}

uint2 irradia_screen_sample(uint2 cell)
{
    float4 _e5 = irradia_screen_view[1];
    return min((2u * cell), (naga_f2u32(_e5.zw) - uint2(1u, 1u)));
}

float3 irradia_screen_irradiance(uint2 pixel)
{
    const irradia_screen_Surface _e1 = irradia_screen_seen(pixel);
    if ((_e1.depth <= 0.0)) {
        return (0.0).xxx;
    }
    const float3 _e8 = irradia_screen_place(pixel, _e1.depth);
    const float3 _e11 = irradia_screen_light(_e8, _e1.normal, _e1.surface_normal);
    return _e11;
}
