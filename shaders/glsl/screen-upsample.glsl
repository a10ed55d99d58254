// Generated from shaders/wgsl/screen-upsample.wgsl by `npm run shaders` in web/: don't edit.
// needs: screen
// given, in WGSL: var irradia_screen_half: texture_2d<f32>

const float irradia_screen_reach = 0.5;

const float irradia_screen_bend = 20.0;

const float irradia_screen_least = 0.75;

float irradia_screen_kinship(vec3 place, vec3 normal_1, float pixel_size, uvec2 neighbour) {
    irradia_screen_Surface _e4 = irradia_screen_seen(neighbour);
    vec3 _e6 = irradia_screen_place(neighbour, _e4.depth);
    vec3 way = _e6 - place;
    float apart = abs(dot(way, normal_1)) / (irradia_screen_reach * pixel_size);
    float turned = (1.0 - dot(normal_1, _e4.normal)) * irradia_screen_bend;
    return (_e4.depth > 0.0) ? (max(0.0, (1.0 - apart)) * max(0.0, (1.0 - turned))) : 0.0;
}

vec3 irradia_screen_upsampled(uvec2 pixel) {
    vec4 sum = vec4(0.0);
    irradia_screen_Surface _e1 = irradia_screen_seen(pixel);
    if (_e1.depth <= 0.0) {
        return vec3(0.0);
    }
    vec3 _e8 = irradia_screen_place(pixel, _e1.depth);
    vec2 steps = abs(irradia_screen_view[0].zw);
    float _e21 = irradia_screen_view[1].x;
    float pixel_size = max(steps.x, steps.y) * mix(_e1.depth, 1.0, _e21);
    uvec2 cell = pixel >> uvec2(1u, 1u);
    vec2 share = 0.5 * vec2((pixel & uvec2(1u, 1u)));
    for (uint i = 0u; i < 4u; i += 1u) {
        uvec2 corner = uvec2((i & 1u), (i >> 1u));
        vec2 near = mix((vec2(1.0) - share), share, vec2(corner));
        float weight = near.x * near.y;
        if (weight > 0.0) {
            uvec2 _e62 = irradia_screen_sample((cell + corner));
            float _e64 = irradia_screen_kinship(_e8, _e1.normal, pixel_size, _e62);
            float counts = weight * _e64;
            vec4 _e70 = texelFetch(irradia_screen_half, ivec2((cell + corner)), 0);
            sum = sum + (counts * vec4(_e70.xyz, 1.0));
        }
    }
    if (sum.w < irradia_screen_least) {
        vec3 _e85 = irradia_screen_light(_e8, _e1.normal, _e1.surface_normal);
        return _e85;
    }
    return sum.xyz / vec3(sum.w);
}
