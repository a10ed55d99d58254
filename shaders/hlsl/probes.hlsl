// Generated from shaders/wgsl/probes.wgsl by `npm run shaders` in web/: don't edit.
// needs: octahedral, cosine-lobe
// given, in WGSL: var irradia_probes: texture_2d_array<u32>
// given, in WGSL: var irradia_probe_sight: texture_2d_array<u32>
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

uint4 irradia_probe_texel(uint index)
{
    uint2 shifts = naga_f2u32(irradia_probe_layout[3].xy);
    uint x = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y = row & ((1u << shifts.y) - 1u);
    uint4 _e27 = irradia_probes.Load(int4(int2(uint2(x, y)), int((row >> shifts.y)), int(0)));
    return _e27;
}

float4 irradia_probe_place(uint probe)
{
    const uint4 _e3 = irradia_probe_texel((5u * probe));
    return asfloat(_e3);
}

uint irradia_probe_word(uint index)
{
    uint2 shifts = naga_f2u32(irradia_probe_layout[3].zw);
    uint x_1 = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y_1 = row & ((1u << shifts.y) - 1u);
    uint4 _e27 = irradia_probe_sight.Load(int4(int2(uint2(x_1, y_1)), int((row >> shifts.y)), int(0)));
    return _e27.x;
}

float2 irradia_probe_seen(uint probe, float2 place)
{
    float _e5 = irradia_probe_layout[2].w;
    const uint _e6 = irradia_octahedral_texel(place, _e5);
    float _e10 = irradia_probe_layout[4].y;
    uint words = naga_f2u32(_e10);
    const uint _e16 = irradia_probe_word(((probe * words) + (_e6 >> 1u)));
    uint pair = _e16 >> (16u * (_e6 & 1u));
    return float2(uint2((pair & 255u), ((pair >> 8u) & 255u))) / (255.0).xx;
}

float irradia_probe_sees(uint probe, float3 direction, float distance_, float reach)
{
    const float2 _e4 = irradia_octahedral_uv(direction);
    float _e8 = irradia_probe_layout[2].w;
    float2 at = (_e4 * _e8) - (0.5).xx;
    float2 base = floor(at);
    float2 share = at - base;
    const float2 _e15 = irradia_probe_seen(probe, base);
    const float2 _e20 = irradia_probe_seen(probe, (base + float2(1.0, 0.0)));
    float2 up = lerp(_e15, _e20, share.x);
    const float2 _e27 = irradia_probe_seen(probe, (base + float2(0.0, 1.0)));
    const float2 _e32 = irradia_probe_seen(probe, (base + float2(1.0, 1.0)));
    float2 down = lerp(_e27, _e32, share.x);
    float2 seen = lerp(up, down, share.y) * reach;
    float deviation = max(seen.y, (0.01 * reach));
    float beyond = max((distance_ - seen.x), 0.0) / deviation;
    float bound = 1.0 / (1.0 + (beyond * beyond));
    return (bound * bound) * bound;
}

float irradia_probe_weight(uint probe, float4 place, float3 position, float3 surface_normal, float on_surface)
{
    float3 towards = place.xyz - position;
    float facing = 0.5 + ((0.5 * dot(towards, surface_normal)) / max(length(towards), 1e-9));
    float side = lerp(1.0, ((facing * facing) + 0.2), on_surface);
    float3 way = (surface_normal * ((0.025 * place.w) * on_surface)) - towards;
    float distance = length(way);
    float3 direction = (distance > 1e-9) ? (way / (max(distance, 1e-9)).xxx) : float3(0.0, 1.0, 0.0);
    const float _e40 = irradia_probe_sees(probe, direction, distance, place.w);
    float crushed = (_e40 < 0.2) ? (((_e40 * _e40) * _e40) / 0.04) : _e40;
    return side * max(crushed, 1e-6);
}

float3 irradia_probe_irradiance(uint probe, float3 n)
{
    float3 e = (float3)0;

    const uint4 _e6 = irradia_probe_texel(((5u * probe) + 1u));
    const uint4 _e11 = irradia_probe_texel(((5u * probe) + 2u));
    const uint4 _e16 = irradia_probe_texel(((5u * probe) + 3u));
    const uint4 _e21 = irradia_probe_texel(((5u * probe) + 4u));
    float2 ax = float2(f16tof32(_e6.x), f16tof32((_e6.x) >> 16));
    float2 ay = float2(f16tof32(_e6.y), f16tof32((_e6.y) >> 16));
    float2 az = float2(f16tof32(_e6.z), f16tof32((_e6.z) >> 16));
    float2 aw = float2(f16tof32(_e6.w), f16tof32((_e6.w) >> 16));
    float2 bx = float2(f16tof32(_e11.x), f16tof32((_e11.x) >> 16));
    float2 by = float2(f16tof32(_e11.y), f16tof32((_e11.y) >> 16));
    float2 bz = float2(f16tof32(_e11.z), f16tof32((_e11.z) >> 16));
    float2 bw = float2(f16tof32(_e11.w), f16tof32((_e11.w) >> 16));
    float2 cx = float2(f16tof32(_e16.x), f16tof32((_e16.x) >> 16));
    float2 cy = float2(f16tof32(_e16.y), f16tof32((_e16.y) >> 16));
    float2 cz = float2(f16tof32(_e16.z), f16tof32((_e16.z) >> 16));
    float2 cw = float2(f16tof32(_e16.w), f16tof32((_e16.w) >> 16));
    float2 dx = float2(f16tof32(_e21.x), f16tof32((_e21.x) >> 16));
    float2 dy = float2(f16tof32(_e21.y), f16tof32((_e21.y) >> 16));
    const float4 _e50 = irradia_lobe_linear(n);
    const float4 _e51 = irradia_lobe_quadratic(n);
    e = _e50.x * float3(ax, ay.x);
    e = e + (_e50.y * float3(ay.y, az));
    e = e + (_e50.z * float3(aw, bx.x));
    e = e + (_e50.w * float3(bx.y, by));
    e = e + (_e51.x * float3(bz, bw.x));
    e = e + (_e51.y * float3(bw.y, cx));
    e = e + (_e51.z * float3(cy, cz.x));
    e = e + (_e51.w * float3(cz.y, cw));
    const float _e100 = irradia_lobe_squares(n);
    e = e + (_e100 * float3(dx, dy.x));
    float _e109 = irradia_probe_layout[4].x;
    return e * _e109;
}

float irradia_probe_validity(uint probe)
{
    const uint4 _e5 = irradia_probe_texel(((5u * probe) + 4u));
    return asfloat(_e5.z);
}
