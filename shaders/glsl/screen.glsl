// Generated from shaders/wgsl/screen.wgsl by `npm run shaders` in web/: don't edit.
// needs: screen-surface
// given, in WGSL: var irradia_screen_prepass: texture_2d<f32>
// given, in WGSL: var<uniform> irradia_screen_view: array<vec4f>
// given, in WGSL: fn irradia_screen_light(position: vec3f, normal: vec3f, surface_normal: vec3f) -> vec3f

irradia_screen_Surface irradia_screen_seen(uvec2 pixel) {
    vec4 _e3 = texelFetch(irradia_screen_prepass, ivec2(pixel), 0);
    irradia_screen_Surface _e4 = irradia_screen_unpacked(_e3);
    return _e4;
}

vec3 irradia_screen_place(uvec2 pixel, float depth) {
    vec2 slope = irradia_screen_view[0].xy + (vec2(pixel) * irradia_screen_view[0].zw);
    float _e16 = irradia_screen_view[1].x;
    vec2 across = slope * mix(depth, 1.0, _e16);
    return (((irradia_screen_view[2].xyz * across.x) + (irradia_screen_view[3].xyz * across.y)) - (irradia_screen_view[4].xyz * depth)) + irradia_screen_view[5].xyz;
}

uvec2 irradia_screen_sample(uvec2 cell) {
    return min((2u * cell), (uvec2(irradia_screen_view[1].zw) - uvec2(1u, 1u)));
}

vec3 irradia_screen_irradiance(uvec2 pixel) {
    irradia_screen_Surface _e1 = irradia_screen_seen(pixel);
    if (_e1.depth <= 0.0) {
        return vec3(0.0);
    }
    vec3 _e8 = irradia_screen_place(pixel, _e1.depth);
    vec3 _e11 = irradia_screen_light(_e8, _e1.normal, _e1.surface_normal);
    return _e11;
}
