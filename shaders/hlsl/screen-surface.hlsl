// Generated from shaders/wgsl/screen-surface.wgsl by `npm run shaders` in web/: don't edit.

struct irradia_screen_Surface {
    float3 normal;
    int _pad1_0;
    float3 surface_normal;
    float depth;
};

static const float irradia_screen_steps = 4095.0;

float2 irradia_screen_folded(float2 p)
{
    return ((1.0).xx - abs(p.yx)) * ((p >= (0.0).xx) ? (1.0).xx : (-1.0).xx);
}

float2 irradia_screen_uv(float3 direction)
{
    float3 p = direction / (((abs(direction.x) + abs(direction.y)) + abs(direction.z))).xxx;
    const float2 _e13 = irradia_screen_folded(p.xz);
    return (0.5 * ((p.y < 0.0) ? _e13 : p.xz)) + (0.5).xx;
}

float4 irradia_screen_packed(float3 normal, float3 surface_normal, float depth)
{
    const float2 _e3 = irradia_screen_uv(surface_normal);
    float2 steps = floor(((_e3 * irradia_screen_steps) + (0.5).xx));
    float both = (steps.x * 4096.0) + steps.y;
    const float2 _e15 = irradia_screen_uv(normal);
    return float4(_e15, both, depth);
}

float3 irradia_screen_direction(float2 uv)
{
    float2 p = (2.0 * uv) - (1.0).xx;
    float y = (1.0 - abs(p.x)) - abs(p.y);
    const float2 _e13 = irradia_screen_folded(p);
    float2 xz = (y < 0.0) ? _e13 : p;
    return normalize(float3(xz.x, y, xz.y));
}

irradia_screen_Surface irradia_screen_unpacked(float4 stored)
{
    irradia_screen_Surface seen = (irradia_screen_Surface)0;

    float row = floor((stored.z / 4096.0));
    float column = stored.z - (row * 4096.0);
    float2 uv = float2(row, column) / (4095.0).xx;
    const float3 _e16 = irradia_screen_direction(stored.xy);
    seen.normal = _e16;
    const float3 _e18 = irradia_screen_direction(uv);
    seen.surface_normal = _e18;
    seen.depth = stored.w;
    const irradia_screen_Surface irradia_screen_surface = seen;
    return irradia_screen_surface;
}
