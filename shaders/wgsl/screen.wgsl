// Light by pixel: evaluated from what a prepass says of the surface behind each pixel.
//
// `irradia_screen_view` says how pixels see: x and y of the view direction at the centre of pixel 0, and their
// steps from pixel to pixel; 1 in x of the second where rays are parallel, the screen's size in zw; then three
// columns and the origin of world_from_view.
// needs: screen-surface
// given: var irradia_screen_prepass: texture_2d<f32>
// given: var<uniform> irradia_screen_view: array<vec4f>
// given: fn irradia_screen_light(position: vec3f, normal: vec3f, surface_normal: vec3f) -> vec3f

fn irradia_screen_seen(pixel: vec2u) -> irradia_screen_Surface {
    return irradia_screen_unpacked(textureLoad(irradia_screen_prepass, pixel, 0));
}

// Where a surface lies in the world.
fn irradia_screen_place(pixel: vec2u, depth: f32) -> vec3f {
    let slope = irradia_screen_view[0].xy + vec2f(pixel) * irradia_screen_view[0].zw;
    let across = slope * mix(depth, 1.0, irradia_screen_view[1].x);
    return irradia_screen_view[2].xyz * across.x
        + irradia_screen_view[3].xyz * across.y
        - irradia_screen_view[4].xyz * depth
        + irradia_screen_view[5].xyz;
}

// The pixel that stands for two by two of them, at half resolution.
fn irradia_screen_sample(cell: vec2u) -> vec2u {
    return min(2u * cell, vec2u(irradia_screen_view[1].zw) - vec2u(1u, 1u));
}

// E of what a pixel shows.
fn irradia_screen_irradiance(pixel: vec2u) -> vec3f {
    let seen = irradia_screen_seen(pixel);
    if seen.depth <= 0.0 {
        return vec3f(0.0);
    }
    let place = irradia_screen_place(pixel, seen.depth);
    return irradia_screen_light(place, seen.normal, seen.surface_normal);
}
