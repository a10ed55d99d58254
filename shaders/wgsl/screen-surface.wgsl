// What a prepass says of the surface behind a pixel, in four floats: the shading normal on an octahedron, the
// surface's own in 2 x 12 bits of one float, and the distance along the view in metres; 0 is no surface.

const irradia_screen_steps: f32 = 4095.0;

struct irradia_screen_Surface {
    normal: vec3f,
    surface_normal: vec3f,
    depth: f32,
}

fn irradia_screen_packed(normal: vec3f, surface_normal: vec3f, depth: f32) -> vec4f {
    let steps = floor(irradia_screen_uv(surface_normal) * irradia_screen_steps + 0.5);
    let both = steps.x * (irradia_screen_steps + 1.0) + steps.y;
    return vec4f(irradia_screen_uv(normal), both, depth);
}

fn irradia_screen_unpacked(stored: vec4f) -> irradia_screen_Surface {
    let row = floor(stored.z / (irradia_screen_steps + 1.0));
    let column = stored.z - row * (irradia_screen_steps + 1.0);
    let uv = vec2f(row, column) / irradia_screen_steps;
    var seen: irradia_screen_Surface;
    seen.normal = irradia_screen_direction(stored.xy);
    seen.surface_normal = irradia_screen_direction(uv);
    seen.depth = stored.w;
    return seen;
}

// Unit directions to [0, 1]; +Y is in the middle.
fn irradia_screen_uv(direction: vec3f) -> vec2f {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    return 0.5 * select(p.xz, irradia_screen_folded(p.xz), p.y < 0.0) + 0.5;
}

// The octahedron's lower half, folded out over the corners, and back in.
fn irradia_screen_folded(p: vec2f) -> vec2f {
    return (1.0 - abs(p.yx)) * select(vec2f(-1.0), vec2f(1.0), p >= vec2f(0.0));
}

fn irradia_screen_direction(uv: vec2f) -> vec3f {
    let p = 2.0 * uv - 1.0;
    let y = 1.0 - abs(p.x) - abs(p.y);
    let xz = select(p, irradia_screen_folded(p), y < 0.0);
    return normalize(vec3f(xz.x, y, xz.y));
}
