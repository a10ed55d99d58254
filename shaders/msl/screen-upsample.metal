// Generated from shaders/wgsl/screen-upsample.wgsl by `npm run shaders` in web/: don't edit.
// needs: screen
// given, in WGSL: var irradia_screen_half: texture_2d<f32>

static constant constexpr const float irradia_screen_reach = 0.5;

static constant constexpr const float irradia_screen_bend = 20.0;

static constant constexpr const float irradia_screen_least = 0.75;

float irradia_screen_kinship(
    metal::float3 place,
    metal::float3 normal_1,
    float pixel_size,
    metal::uint2 neighbour
) {
    irradia_screen_Surface _e4 = irradia_screen_seen(neighbour);
    metal::float3 _e6 = irradia_screen_place(neighbour, _e4.depth);
    metal::float3 way = _e6 - place;
    float apart = metal::abs(metal::dot(way, normal_1)) / (irradia_screen_reach * pixel_size);
    float turned = (1.0 - metal::dot(normal_1, _e4.normal)) * irradia_screen_bend;
    return (_e4.depth > 0.0) ? (metal::max(0.0, 1.0 - apart) * metal::max(0.0, 1.0 - turned)) : 0.0;
}

metal::float3 irradia_screen_upsampled(
    metal::uint2 pixel
) {
    metal::float4 sum = metal::float4(0.0);
    irradia_screen_Surface _e1 = irradia_screen_seen(pixel);
    if (_e1.depth <= 0.0) {
        return metal::float3(0.0);
    }
    metal::float3 _e8 = irradia_screen_place(pixel, _e1.depth);
    metal::float2 steps = metal::abs(irradia_screen_view[0].zw);
    float _e21 = irradia_screen_view[1].x;
    float pixel_size = metal::max(steps.x, steps.y) * metal::mix(_e1.depth, 1.0, _e21);
    metal::uint2 cell = pixel >> metal::uint2(1u, 1u);
    metal::float2 share = 0.5 * static_cast<metal::float2>(pixel & metal::uint2(1u, 1u));
    for (uint i = 0u; i < 4u; i += 1u) {
        metal::uint2 corner = metal::uint2(i & 1u, i >> 1u);
        metal::float2 near = metal::mix(metal::float2(1.0) - share, share, static_cast<metal::float2>(corner));
        float weight = near.x * near.y;
        if (weight > 0.0) {
            metal::uint2 _e62 = irradia_screen_sample(cell + corner);
            float _e64 = irradia_screen_kinship(_e8, _e1.normal, pixel_size, _e62);
            float counts = weight * _e64;
            metal::float4 _e70 = irradia_screen_half.read(metal::uint2(cell + corner), 0);
            sum = sum + (counts * metal::float4(_e70.xyz, 1.0));
        }
    }
    if (sum.w < irradia_screen_least) {
        metal::float3 _e85 = irradia_screen_light(_e8, _e1.normal, _e1.surface_normal);
        return _e85;
    }
    return sum.xyz / metal::float3(sum.w);
}
