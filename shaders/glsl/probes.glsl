// Generated from shaders/wgsl/probes.wgsl by `npm run shaders` in web/: don't edit.
// needs: octahedral, cosine-lobe
// given, in WGSL: var irradia_probes: texture_2d_array<u32>
// given, in WGSL: var irradia_probe_sight: texture_2d_array<u32>
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

uvec4 irradia_probe_texel(uint index) {
    uvec2 shifts = uvec2(irradia_probe_layout[3].xy);
    uint x = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y = row & ((1u << shifts.y) - 1u);
    uvec4 _e27 = texelFetch(irradia_probes, ivec3(ivec2(uvec2(x, y)), int((row >> shifts.y))), 0);
    return _e27;
}

vec4 irradia_probe_place(uint probe) {
    uvec4 _e3 = irradia_probe_texel((5u * probe));
    return uintBitsToFloat(_e3);
}

uint irradia_probe_word(uint index) {
    uvec2 shifts = uvec2(irradia_probe_layout[3].zw);
    uint x_1 = index & ((1u << shifts.x) - 1u);
    uint row = index >> shifts.x;
    uint y_1 = row & ((1u << shifts.y) - 1u);
    uvec4 _e27 = texelFetch(irradia_probe_sight, ivec3(ivec2(uvec2(x_1, y_1)), int((row >> shifts.y))), 0);
    return _e27.x;
}

vec2 irradia_probe_seen(uint probe, vec2 place) {
    float _e5 = irradia_probe_layout[2].w;
    uint _e6 = irradia_octahedral_texel(place, _e5);
    float _e10 = irradia_probe_layout[4].y;
    uint words = uint(_e10);
    uint _e16 = irradia_probe_word(((probe * words) + (_e6 >> 1u)));
    uint pair = _e16 >> (16u * (_e6 & 1u));
    return vec2(uvec2((pair & 255u), ((pair >> 8u) & 255u))) / vec2(255.0);
}

float irradia_probe_sees(uint probe, vec3 direction, float distance_, float reach) {
    vec2 _e4 = irradia_octahedral_uv(direction);
    float _e8 = irradia_probe_layout[2].w;
    vec2 at = (_e4 * _e8) - vec2(0.5);
    vec2 base = floor(at);
    vec2 share = at - base;
    vec2 _e15 = irradia_probe_seen(probe, base);
    vec2 _e20 = irradia_probe_seen(probe, (base + vec2(1.0, 0.0)));
    vec2 up = mix(_e15, _e20, share.x);
    vec2 _e27 = irradia_probe_seen(probe, (base + vec2(0.0, 1.0)));
    vec2 _e32 = irradia_probe_seen(probe, (base + vec2(1.0, 1.0)));
    vec2 down = mix(_e27, _e32, share.x);
    vec2 seen = mix(up, down, share.y) * reach;
    float deviation = max(seen.y, (0.01 * reach));
    float beyond = max((distance_ - seen.x), 0.0) / deviation;
    float bound = 1.0 / (1.0 + (beyond * beyond));
    return (bound * bound) * bound;
}

float irradia_probe_weight(uint probe, vec4 place, vec3 position, vec3 surface_normal, float on_surface) {
    vec3 towards = place.xyz - position;
    float facing = 0.5 + ((0.5 * dot(towards, surface_normal)) / max(length(towards), 1e-9));
    float side = mix(1.0, ((facing * facing) + 0.2), on_surface);
    vec3 way = (surface_normal * ((0.025 * place.w) * on_surface)) - towards;
    float distance = length(way);
    vec3 direction = (distance > 1e-9) ? (way / vec3(max(distance, 1e-9))) : vec3(0.0, 1.0, 0.0);
    float _e40 = irradia_probe_sees(probe, direction, distance, place.w);
    float crushed = (_e40 < 0.2) ? (((_e40 * _e40) * _e40) / 0.04) : _e40;
    return side * max(crushed, 1e-6);
}

vec3 irradia_probe_irradiance(uint probe, vec3 n) {
    vec3 e = vec3(0.0);
    uvec4 _e6 = irradia_probe_texel(((5u * probe) + 1u));
    uvec4 _e11 = irradia_probe_texel(((5u * probe) + 2u));
    uvec4 _e16 = irradia_probe_texel(((5u * probe) + 3u));
    uvec4 _e21 = irradia_probe_texel(((5u * probe) + 4u));
    vec2 ax = unpackHalf2x16(_e6.x);
    vec2 ay = unpackHalf2x16(_e6.y);
    vec2 az = unpackHalf2x16(_e6.z);
    vec2 aw = unpackHalf2x16(_e6.w);
    vec2 bx = unpackHalf2x16(_e11.x);
    vec2 by = unpackHalf2x16(_e11.y);
    vec2 bz = unpackHalf2x16(_e11.z);
    vec2 bw = unpackHalf2x16(_e11.w);
    vec2 cx = unpackHalf2x16(_e16.x);
    vec2 cy = unpackHalf2x16(_e16.y);
    vec2 cz = unpackHalf2x16(_e16.z);
    vec2 cw = unpackHalf2x16(_e16.w);
    vec2 dx = unpackHalf2x16(_e21.x);
    vec2 dy = unpackHalf2x16(_e21.y);
    vec4 _e50 = irradia_lobe_linear(n);
    vec4 _e51 = irradia_lobe_quadratic(n);
    e = _e50.x * vec3(ax, ay.x);
    e = e + (_e50.y * vec3(ay.y, az));
    e = e + (_e50.z * vec3(aw, bx.x));
    e = e + (_e50.w * vec3(bx.y, by));
    e = e + (_e51.x * vec3(bz, bw.x));
    e = e + (_e51.y * vec3(bw.y, cx));
    e = e + (_e51.z * vec3(cy, cz.x));
    e = e + (_e51.w * vec3(cz.y, cw));
    float _e100 = irradia_lobe_squares(n);
    e = e + (_e100 * vec3(dx, dy.x));
    float _e109 = irradia_probe_layout[4].x;
    return e * _e109;
}

float irradia_probe_validity(uint probe) {
    uvec4 _e5 = irradia_probe_texel(((5u * probe) + 4u));
    return uintBitsToFloat(_e5.z);
}
