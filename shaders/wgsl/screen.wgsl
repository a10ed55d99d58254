// Light by pixel: evaluated from what a prepass says of the surface behind each pixel.
//
// The prepass stores the shading normal in world space and the distance along the view, in metres; 0 is no
// surface. `irradia_screen_view` says how pixels see: x and y of the view direction at the centre of pixel 0, and
// their steps from pixel to pixel; 1 in x of the second where rays are parallel, the screen's size in zw;
// then three columns and the origin of world_from_view.
// given: var irradia_screen_surface: texture_2d<f32>
// given: var<uniform> irradia_screen_view: array<vec4f>
// given: fn irradia_light(position: vec3f, normal: vec3f) -> vec3f

// Normal and distance.
fn irradia_screen_seen(pixel: vec2u) -> vec4f {
    return textureLoad(irradia_screen_surface, pixel, 0);
}

// Where the surface behind a pixel lies in the world.
fn irradia_screen_place(pixel: vec2u, distance: f32) -> vec3f {
    let slope = irradia_screen_view[0].xy + vec2f(pixel) * irradia_screen_view[0].zw;
    let across = slope * mix(distance, 1.0, irradia_screen_view[1].x);
    return irradia_screen_view[2].xyz * across.x
        + irradia_screen_view[3].xyz * across.y
        - irradia_screen_view[4].xyz * distance
        + irradia_screen_view[5].xyz;
}

// The pixel that stands for two by two of them, at half resolution.
fn irradia_screen_sample(cell: vec2u) -> vec2u {
    return min(2u * cell, vec2u(irradia_screen_view[1].zw) - vec2u(1u, 1u));
}

// E of what a pixel shows.
fn irradia_screen_irradiance(pixel: vec2u) -> vec3f {
    let seen = irradia_screen_seen(pixel);
    if seen.w <= 0.0 {
        return vec3f(0.0);
    }
    return irradia_light(irradia_screen_place(pixel, seen.w), normalize(seen.xyz));
}
