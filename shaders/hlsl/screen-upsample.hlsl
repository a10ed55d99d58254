// Generated from shaders/wgsl/screen-upsample.wgsl by `npm run shaders` in web/: don't edit.
// needs: screen
// given, in WGSL: var irradia_screen_half: texture_2d<f32>

static const float irradia_screen_reach = 4.0;

static const float irradia_screen_bend = 10.0;

static const float irradia_screen_least = 0.25;

float irradia_screen_kinship(float3 place, float3 normal, float pixel_size, uint2 neighbour)
{
    const float4 _e4 = irradia_screen_seen(neighbour);
    const float3 _e6 = irradia_screen_place(neighbour, _e4.w);
    float3 way = (_e6 - place);
    float apart = (abs(dot(way, normal)) / (irradia_screen_reach * pixel_size));
    float turned = ((1.0 - dot(normal, _e4.xyz)) * irradia_screen_bend);
    return ((_e4.w > 0.0) ? (max(0.0, (1.0 - apart)) * max(0.0, (1.0 - turned))) : 0.0);
}

float3 irradia_screen_upsampled(uint2 pixel)
{
    float4 sum = (0.0).xxxx;

    const float4 _e1 = irradia_screen_seen(pixel);
    if ((_e1.w <= 0.0)) {
        return (0.0).xxx;
    }
    float3 normal = normalize(_e1.xyz);
    const float3 _e10 = irradia_screen_place(pixel, _e1.w);
    float4 _e13 = irradia_screen_view[0];
    float2 steps = abs(_e13.zw);
    float _e23 = irradia_screen_view[1].x;
    float pixel_size = (max(steps.x, steps.y) * lerp(_e1.w, 1.0, _e23));
    uint2 cell = (pixel >> uint2(1u, 1u));
    float2 share = (0.5 * float2((pixel & uint2(1u, 1u))));
    for (uint i = 0u; i < 4u; i += 1u) {
        uint _e46 = i;
        uint _e49 = i;
        uint2 corner = uint2((_e46 & 1u), (_e49 >> 1u));
        float2 near = lerp(((1.0).xx - share), share, float2(corner));
        float weight = (near.x * near.y);
        if ((weight > 0.0)) {
            const uint2 _e64 = irradia_screen_sample((cell + corner));
            const float _e65 = irradia_screen_kinship(_e10, normal, pixel_size, _e64);
            float counts = (weight * _e65);
            float4 _e67 = sum;
            float4 _e71 = irradia_screen_half.Load(int3((cell + corner), int(0)));
            sum = (_e67 + (counts * float4(_e71.xyz, 1.0)));
        }
    }
    float _e81 = sum.w;
    if ((_e81 < irradia_screen_least)) {
        const float3 _e84 = irradia_light(_e10, normal);
        return _e84;
    }
    float4 _e85 = sum;
    float _e88 = sum.w;
    return (_e85.xyz / (_e88).xxx);
}
