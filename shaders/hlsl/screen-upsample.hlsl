// Generated from shaders/wgsl/screen-upsample.wgsl by `npm run shaders` in web/: don't edit.
// needs: screen
// given, in WGSL: var irradia_screen_half: texture_2d<f32>

static const float irradia_screen_reach = 0.5;

static const float irradia_screen_bend = 20.0;

static const float irradia_screen_least = 0.75;

float irradia_screen_kinship(float3 place, float3 normal_1, float pixel_size, uint2 neighbour)
{
    const irradia_screen_Surface _e4 = irradia_screen_seen(neighbour);
    const float3 _e6 = irradia_screen_place(neighbour, _e4.depth);
    float3 way = _e6 - place;
    float apart = abs(dot(way, normal_1)) / (irradia_screen_reach * pixel_size);
    float turned = (1.0 - dot(normal_1, _e4.normal)) * irradia_screen_bend;
    return (_e4.depth > 0.0) ? (max(0.0, (1.0 - apart)) * max(0.0, (1.0 - turned))) : 0.0;
}

float3 irradia_screen_upsampled(uint2 pixel)
{
    float4 sum = (0.0).xxxx;

    const irradia_screen_Surface _e1 = irradia_screen_seen(pixel);
    if (_e1.depth <= 0.0) {
        return (0.0).xxx;
    }
    const float3 _e8 = irradia_screen_place(pixel, _e1.depth);
    float2 steps = abs(irradia_screen_view[0].zw);
    float _e21 = irradia_screen_view[1].x;
    float pixel_size = max(steps.x, steps.y) * lerp(_e1.depth, 1.0, _e21);
    uint2 cell = pixel >> uint2(1u, 1u);
    float2 share = 0.5 * float2((pixel & uint2(1u, 1u)));
    for (uint i = 0u; i < 4u; i += 1u) {
        uint2 corner = uint2((i & 1u), (i >> 1u));
        float2 near = lerp(((1.0).xx - share), share, float2(corner));
        float weight = near.x * near.y;
        if (weight > 0.0) {
            const uint2 _e62 = irradia_screen_sample((cell + corner));
            const float _e64 = irradia_screen_kinship(_e8, _e1.normal, pixel_size, _e62);
            float counts = weight * _e64;
            float4 _e70 = irradia_screen_half.Load(int3((cell + corner), int(0)));
            sum = sum + (counts * float4(_e70.xyz, 1.0));
        }
    }
    if (sum.w < irradia_screen_least) {
        const float3 _e85 = irradia_screen_light(_e8, _e1.normal, _e1.surface_normal);
        return _e85;
    }
    return sum.xyz / (sum.w).xxx;
}
