// Generated from shaders/wgsl/screen-surface.wgsl by `npm run shaders` in web/: don't edit.

struct irradia_screen_Surface {
    vec3 normal;
    vec3 surface_normal;
    float depth;
};

const float irradia_screen_steps = 4095.0;

vec2 irradia_screen_folded(vec2 p) {
    return (vec2(1.0) - abs(p.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
}

vec2 irradia_screen_uv(vec3 direction) {
    vec3 p = direction / vec3(((abs(direction.x) + abs(direction.y)) + abs(direction.z)));
    vec2 _e13 = irradia_screen_folded(p.xz);
    return (0.5 * ((p.y < 0.0) ? _e13 : p.xz)) + vec2(0.5);
}

vec4 irradia_screen_packed(vec3 normal, vec3 surface_normal, float depth) {
    vec2 _e3 = irradia_screen_uv(surface_normal);
    vec2 steps = floor(((_e3 * irradia_screen_steps) + vec2(0.5)));
    float both = (steps.x * 4096.0) + steps.y;
    vec2 _e15 = irradia_screen_uv(normal);
    return vec4(_e15, both, depth);
}

vec3 irradia_screen_direction(vec2 uv) {
    vec2 p = (2.0 * uv) - vec2(1.0);
    float y = (1.0 - abs(p.x)) - abs(p.y);
    vec2 _e13 = irradia_screen_folded(p);
    vec2 xz = (y < 0.0) ? _e13 : p;
    return normalize(vec3(xz.x, y, xz.y));
}

irradia_screen_Surface irradia_screen_unpacked(vec4 stored) {
    irradia_screen_Surface seen = irradia_screen_Surface(vec3(0.0), vec3(0.0), 0.0);
    float row = floor((stored.z / 4096.0));
    float column = stored.z - (row * 4096.0);
    vec2 uv = vec2(row, column) / vec2(4095.0);
    vec3 _e16 = irradia_screen_direction(stored.xy);
    seen.normal = _e16;
    vec3 _e18 = irradia_screen_direction(uv);
    seen.surface_normal = _e18;
    seen.depth = stored.w;
    return seen;
}
