// Generated from shaders/wgsl/probes.wgsl by `npm run shaders` in web/: don't edit.
// needs: octahedral, cosine-lobe
// given, in WGSL: var irradia_probes: texture_2d_array<u32>
// given, in WGSL: var irradia_probe_sight: texture_2d_array<u32>
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

metal::uint4 irradia_probe_texel(
    uint index
) {
    metal::uint2 shifts = naga_f2u32(irradia_probe_layout[3].xy);
    uint x = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y = row & ((1u << shifts.y) - 1u);
    metal::uint4 _e27 = irradia_probes.read(metal::uint2(static_cast<metal::int2>(metal::uint2(x, y))), static_cast<int>(row >> shifts.y), 0);
    return _e27;
}

metal::float4 irradia_probe_place(
    uint probe
) {
    metal::uint4 _e3 = irradia_probe_texel(5u * probe);
    return as_type<metal::float4>(_e3);
}

uint irradia_probe_word(
    uint index
) {
    metal::uint2 shifts = naga_f2u32(irradia_probe_layout[3].zw);
    uint x_1 = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y_1 = row & ((1u << shifts.y) - 1u);
    metal::uint4 _e27 = irradia_probe_sight.read(metal::uint2(static_cast<metal::int2>(metal::uint2(x_1, y_1))), static_cast<int>(row >> shifts.y), 0);
    return _e27.x;
}

metal::float2 irradia_probe_seen(
    uint probe,
    metal::float2 place
) {
    float _e5 = irradia_probe_layout[2].w;
    uint _e6 = irradia_octahedral_texel(place, _e5);
    float _e10 = irradia_probe_layout[4].y;
    uint words = naga_f2u32(_e10);
    uint _e16 = irradia_probe_word((probe * words) + (_e6 >> 1u));
    uint pair = _e16 >> (16u * (_e6 & 1u));
    return static_cast<metal::float2>(metal::uint2(pair & 255u, (pair >> 8u) & 255u)) / metal::float2(255.0);
}

float irradia_probe_sees(
    uint probe,
    metal::float3 direction,
    float distance,
    float reach
) {
    metal::float2 _e4 = irradia_octahedral_uv(direction);
    float _e8 = irradia_probe_layout[2].w;
    metal::float2 at = (_e4 * _e8) - metal::float2(0.5);
    metal::float2 base = metal::floor(at);
    metal::float2 share = at - base;
    metal::float2 _e15 = irradia_probe_seen(probe, base);
    metal::float2 _e20 = irradia_probe_seen(probe, base + metal::float2(1.0, 0.0));
    metal::float2 up = metal::mix(_e15, _e20, share.x);
    metal::float2 _e27 = irradia_probe_seen(probe, base + metal::float2(0.0, 1.0));
    metal::float2 _e32 = irradia_probe_seen(probe, base + metal::float2(1.0, 1.0));
    metal::float2 down = metal::mix(_e27, _e32, share.x);
    metal::float2 seen = metal::mix(up, down, share.y) * reach;
    float deviation = metal::max(seen.y, 0.01 * reach);
    float beyond = metal::max(distance - seen.x, 0.0) / deviation;
    float bound = 1.0 / (1.0 + (beyond * beyond));
    return (bound * bound) * bound;
}

float irradia_probe_weight(
    uint probe,
    metal::float4 place,
    metal::float3 position,
    metal::float3 surface_normal,
    float on_surface
) {
    metal::float3 towards = place.xyz - position;
    float facing = 0.5 + ((0.5 * metal::dot(towards, surface_normal)) / metal::max(metal::length(towards), 0.000000001));
    float side = metal::mix(1.0, (facing * facing) + 0.2, on_surface);
    metal::float3 way = (surface_normal * ((0.025 * place.w) * on_surface)) - towards;
    float distance = metal::length(way);
    metal::float3 direction = (distance > 0.000000001) ? (way / metal::float3(metal::max(distance, 0.000000001))) : metal::float3(0.0, 1.0, 0.0);
    float _e40 = irradia_probe_sees(probe, direction, distance, place.w);
    float crushed = (_e40 < 0.2) ? (((_e40 * _e40) * _e40) / 0.04) : _e40;
    return side * metal::max(crushed, 0.000001);
}

metal::float3 irradia_probe_irradiance(
    uint probe,
    metal::float3 n
) {
    metal::float3 e = {};
    metal::uint4 _e6 = irradia_probe_texel((5u * probe) + 1u);
    metal::uint4 _e11 = irradia_probe_texel((5u * probe) + 2u);
    metal::uint4 _e16 = irradia_probe_texel((5u * probe) + 3u);
    metal::uint4 _e21 = irradia_probe_texel((5u * probe) + 4u);
    metal::float2 ax = float2(as_type<half2>(_e6.x));
    metal::float2 ay = float2(as_type<half2>(_e6.y));
    metal::float2 az = float2(as_type<half2>(_e6.z));
    metal::float2 aw = float2(as_type<half2>(_e6.w));
    metal::float2 bx = float2(as_type<half2>(_e11.x));
    metal::float2 by = float2(as_type<half2>(_e11.y));
    metal::float2 bz = float2(as_type<half2>(_e11.z));
    metal::float2 bw = float2(as_type<half2>(_e11.w));
    metal::float2 cx = float2(as_type<half2>(_e16.x));
    metal::float2 cy = float2(as_type<half2>(_e16.y));
    metal::float2 cz = float2(as_type<half2>(_e16.z));
    metal::float2 cw = float2(as_type<half2>(_e16.w));
    metal::float2 dx = float2(as_type<half2>(_e21.x));
    metal::float2 dy = float2(as_type<half2>(_e21.y));
    metal::float4 _e50 = irradia_lobe_linear(n);
    metal::float4 _e51 = irradia_lobe_quadratic(n);
    e = _e50.x * metal::float3(ax, ay.x);
    e = e + (_e50.y * metal::float3(ay.y, az));
    e = e + (_e50.z * metal::float3(aw, bx.x));
    e = e + (_e50.w * metal::float3(bx.y, by));
    e = e + (_e51.x * metal::float3(bz, bw.x));
    e = e + (_e51.y * metal::float3(bw.y, cx));
    e = e + (_e51.z * metal::float3(cy, cz.x));
    e = e + (_e51.w * metal::float3(cz.y, cw));
    float _e100 = irradia_lobe_squares(n);
    e = e + (_e100 * metal::float3(dx, dy.x));
    float _e109 = irradia_probe_layout[4].x;
    return e * _e109;
}

float irradia_probe_validity(
    uint probe
) {
    metal::uint4 _e5 = irradia_probe_texel((5u * probe) + 4u);
    return as_type<float>(_e5.z);
}
