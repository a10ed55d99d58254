// Generated from shaders/wgsl/screen-surface.wgsl by `npm run shaders` in web/: don't edit.

struct irradia_screen_Surface {
    metal::float3 normal;
    metal::packed_float3 surface_normal;
    float depth;
};

static constant constexpr const float irradia_screen_steps = 4095.0;

metal::float2 irradia_screen_folded(
    metal::float2 p
) {
    return (metal::float2(1.0) - metal::abs(p.yx)) * metal::select(metal::float2(-1.0), metal::float2(1.0), p >= metal::float2(0.0));
}

metal::float2 irradia_screen_uv(
    metal::float3 direction
) {
    metal::float3 p = direction / metal::float3((metal::abs(direction.x) + metal::abs(direction.y)) + metal::abs(direction.z));
    metal::float2 _e13 = irradia_screen_folded(p.xz);
    return (0.5 * ((p.y < 0.0) ? _e13 : p.xz)) + metal::float2(0.5);
}

metal::float4 irradia_screen_packed(
    metal::float3 normal,
    metal::float3 surface_normal,
    float depth
) {
    metal::float2 _e3 = irradia_screen_uv(surface_normal);
    metal::float2 steps = metal::floor((_e3 * irradia_screen_steps) + metal::float2(0.5));
    float both = (steps.x * 4096.0) + steps.y;
    metal::float2 _e15 = irradia_screen_uv(normal);
    return metal::float4(_e15, both, depth);
}

metal::float3 irradia_screen_direction(
    metal::float2 uv
) {
    metal::float2 p = (2.0 * uv) - metal::float2(1.0);
    float y = (1.0 - metal::abs(p.x)) - metal::abs(p.y);
    metal::float2 _e13 = irradia_screen_folded(p);
    metal::float2 xz = (y < 0.0) ? _e13 : p;
    return metal::normalize(metal::float3(xz.x, y, xz.y));
}

irradia_screen_Surface irradia_screen_unpacked(
    metal::float4 stored
) {
    irradia_screen_Surface seen = {};
    float row = metal::floor(stored.z / 4096.0);
    float column = stored.z - (row * 4096.0);
    metal::float2 uv = metal::float2(row, column) / metal::float2(4095.0);
    metal::float3 _e16 = irradia_screen_direction(stored.xy);
    seen.normal = _e16;
    metal::float3 _e18 = irradia_screen_direction(uv);
    seen.surface_normal = _e18;
    seen.depth = stored.w;
    return seen;
}
