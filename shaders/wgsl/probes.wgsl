// How much a light probe counts at a place, and its light: sight from octahedral distance maps. docs/probes.md
//
// After Majercik et al. 2019, "Dynamic Diffuse Global Illumination with Ray-Traced Irradiance Fields".
// A probe is five texels of `irradia_probes`: place and reach as the bits of floats, the reach negative where
// the probe doesn't count; then 27 coefficients as pairs of halfs, and behind them the validity's bits. Two texels
// of its map share a word of `irradia_probe_sight`: mean and deviation in 255ths of the reach, lowest byte first.
// needs: octahedral, cosine-lobe
// given: var irradia_probes: texture_2d_array<u32>
// given: var irradia_probe_sight: texture_2d_array<u32>
// given: var<uniform> irradia_probe_layout: array<vec4f>

// A place's probe, and how far that sees.
fn irradia_probe_place(probe: u32) -> vec4f {
    return bitcast<vec4f>(irradia_probe_texel(5u * probe));
}

// Texel of a list; sides of its texture are powers of two.
fn irradia_probe_texel(index: u32) -> vec4u {
    let shifts = vec2u(irradia_probe_layout[3].xy);
    let x = index & ((1u << shifts.x) - 1u);
    let row = index >> shifts.x;
    let y = row & ((1u << shifts.y) - 1u);
    return textureLoad(irradia_probes, vec2i(vec2u(x, y)), i32(row >> shifts.y), 0);
}

// Word of the maps' list.
fn irradia_probe_word(index: u32) -> u32 {
    let shifts = vec2u(irradia_probe_layout[3].zw);
    let x = index & ((1u << shifts.x) - 1u);
    let row = index >> shifts.x;
    let y = row & ((1u << shifts.y) - 1u);
    return textureLoad(irradia_probe_sight, vec2i(vec2u(x, y)), i32(row >> shifts.y), 0).x;
}

// Mean and deviation of how far a probe sees, as shares of its reach, at a texel (column, row) of its map.
fn irradia_probe_seen(probe: u32, place: vec2f) -> vec2f {
    let texel = irradia_octahedral_texel(place, irradia_probe_layout[2].w);
    let words = u32(irradia_probe_layout[4].y);
    let pair = irradia_probe_word(probe * words + (texel >> 1u)) >> (16u * (texel & 1u));
    return vec2f(vec2u(pair & 255u, (pair >> 8u) & 255u)) / 255.0;
}

// A bound on the share of a probe's rays in a direction that get further than `distance`, by Chebyshev.
fn irradia_probe_sees(probe: u32, direction: vec3f, distance: f32, reach: f32) -> f32 {
    let at = irradia_octahedral_uv(direction) * irradia_probe_layout[2].w - 0.5;
    let base = floor(at);
    let share = at - base;
    let up = mix(
        irradia_probe_seen(probe, base),
        irradia_probe_seen(probe, base + vec2f(1.0, 0.0)),
        share.x,
    );
    let down = mix(
        irradia_probe_seen(probe, base + vec2f(0.0, 1.0)),
        irradia_probe_seen(probe, base + vec2f(1.0, 1.0)),
        share.x,
    );
    let seen = mix(up, down, share.y) * reach;
    let deviation = max(seen.y, 0.01 * reach);
    let beyond = max(distance - seen.x, 0.0) / deviation;
    let bound = 1.0 / (1.0 + beyond * beyond);
    return bound * bound * bound;
}

// What a probe counts beside its share of the cell. In free space `on_surface` is 0, else 1.
fn irradia_probe_weight(
    probe: u32,
    place: vec4f,
    position: vec3f,
    surface_normal: vec3f,
    on_surface: f32,
) -> f32 {
    let towards = place.xyz - position;
    let facing = 0.5 + 0.5 * dot(towards, surface_normal) / max(length(towards), 1e-9);
    let side = mix(1.0, facing * facing + 0.2, on_surface);
    // Places on surfaces are looked at from a little above.
    let way = surface_normal * (0.025 * place.w * on_surface) - towards;
    let distance = length(way);
    let direction = select(vec3f(0.0, 1.0, 0.0), way / max(distance, 1e-9), distance > 1e-9);
    let sight = irradia_probe_sees(probe, direction, distance, place.w);
    // Small shares fall off with their cube, which hides the tail of Chebyshev's bound.
    let crushed = select(sight, sight * sight * sight / 0.04, sight < 0.2);
    return side * max(crushed, 1e-6);
}

// E from a probe alone, for a normal; may be negative. Coefficients stand in the order of cosine-lobe.
fn irradia_probe_irradiance(probe: u32, n: vec3f) -> vec3f {
    let a = irradia_probe_texel(5u * probe + 1u);
    let b = irradia_probe_texel(5u * probe + 2u);
    let c = irradia_probe_texel(5u * probe + 3u);
    let d = irradia_probe_texel(5u * probe + 4u);
    let ax = unpack2x16float(a.x);
    let ay = unpack2x16float(a.y);
    let az = unpack2x16float(a.z);
    let aw = unpack2x16float(a.w);
    let bx = unpack2x16float(b.x);
    let by = unpack2x16float(b.y);
    let bz = unpack2x16float(b.z);
    let bw = unpack2x16float(b.w);
    let cx = unpack2x16float(c.x);
    let cy = unpack2x16float(c.y);
    let cz = unpack2x16float(c.z);
    let cw = unpack2x16float(c.w);
    let dx = unpack2x16float(d.x);
    let dy = unpack2x16float(d.y);
    let linear = irradia_lobe_linear(n);
    let quadratic = irradia_lobe_quadratic(n);
    var e = linear.x * vec3f(ax, ay.x);
    e += linear.y * vec3f(ay.y, az);
    e += linear.z * vec3f(aw, bx.x);
    e += linear.w * vec3f(bx.y, by);
    e += quadratic.x * vec3f(bz, bw.x);
    e += quadratic.y * vec3f(bw.y, cx);
    e += quadratic.z * vec3f(cy, cz.x);
    e += quadratic.w * vec3f(cz.y, cw);
    e += irradia_lobe_squares(n) * vec3f(dx, dy.x);
    return e * irradia_probe_layout[4].x;
}

// The share of directions in which a probe sees no back face.
fn irradia_probe_validity(probe: u32) -> f32 {
    return bitcast<f32>(irradia_probe_texel(5u * probe + 4u).z);
}
