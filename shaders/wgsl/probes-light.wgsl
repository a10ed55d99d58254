// The light between probes, without it coming through walls.
// needs: probes, probe-cell
// given: var<uniform> irradia_probe_layout: array<vec4f>

// A corner's trilinear share.
fn irradia_probe_share(share: vec3f, corner: u32) -> f32 {
    let high = vec3<bool>((corner & 1u) != 0u, (corner & 2u) != 0u, (corner & 4u) != 0u);
    let along = select(1.0 - share, share, high);
    return along.x * along.y * along.z;
}

fn irradia_light(position: vec3f, normal: vec3f, surface_normal: vec3f) -> vec3f {
    let cell = irradia_probe_cell(position);
    let on_surface = irradia_probe_layout[1].w;
    var light = vec3f(0.0);
    var total = 0.0;
    for (var corner = 0u; corner < 8u; corner++) {
        let share = irradia_probe_share(cell.xyz, corner);
        let probe = irradia_probe_corner(cell.w, corner);
        if share > 0.0 && probe != 0xffffffffu {
            let place = irradia_probe_place(probe);
            if place.w > 0.0 {
                let weight = share * irradia_probe_weight(probe, place, position, surface_normal, on_surface);
                light += weight * irradia_probe_irradiance(probe, normal);
                total += weight;
            }
        }
    }
    return max(light / max(total, 1e-30), vec3f(0.0));
}

// The validity of the probes around, from 0 (inside walls) to 1, as their trilinear shares mix it.
fn irradia_view_validity(position: vec3f, normal: vec3f, surface_normal: vec3f) -> vec3f {
    let cell = irradia_probe_cell(position);
    var validity = 0.0;
    var total = 0.0;
    for (var corner = 0u; corner < 8u; corner++) {
        let share = irradia_probe_share(cell.xyz, corner);
        let probe = irradia_probe_corner(cell.w, corner);
        if probe != 0xffffffffu {
            validity += share * irradia_probe_validity(probe);
            total += share;
        }
    }
    return vec3f(validity / max(total, 1e-30));
}
