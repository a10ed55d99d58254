// Generated from shaders/wgsl/probes-light.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes, probe-cell
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

float irradia_probe_share(vec3 share, uint corner) {
    bvec3 high = bvec3(((corner & 1u) != 0u), ((corner & 2u) != 0u), ((corner & 4u) != 0u));
    vec3 along = mix((vec3(1.0) - share), share, high);
    return (along.x * along.y) * along.z;
}

vec3 irradia_light(vec3 position, vec3 normal, vec3 surface_normal) {
    vec3 light = vec3(0.0);
    float total = 0.0;
    bool local = false;
    vec4 _e3 = irradia_probe_cell(position);
    float on_surface = irradia_probe_layout[1].w;
    for (uint corner = 0u; corner < 8u; corner += 1u) {
        float _e20 = irradia_probe_share(_e3.xyz, corner);
        uint _e23 = irradia_probe_corner(_e3.w, corner);
        if (_e20 > 0.0) {
            local = _e23 != 4294967295u;
        } else {
            local = false;
        }
        if (local) {
            vec4 _e32 = irradia_probe_place(_e23);
            if (_e32.w > 0.0) {
                float _e36 = irradia_probe_weight(_e23, _e32, position, surface_normal, on_surface);
                float weight = _e20 * _e36;
                vec3 _e39 = irradia_probe_irradiance(_e23, normal);
                light = light + (weight * _e39);
                total = total + weight;
            }
        }
    }
    return max((light / vec3(max(total, 1e-30))), vec3(0.0));
}

vec3 irradia_view_validity(vec3 position, vec3 normal, vec3 surface_normal) {
    float validity = 0.0;
    float total = 0.0;
    vec4 _e3 = irradia_probe_cell(position);
    for (uint corner = 0u; corner < 8u; corner += 1u) {
        float _e15 = irradia_probe_share(_e3.xyz, corner);
        uint _e18 = irradia_probe_corner(_e3.w, corner);
        if (_e18 != 4294967295u) {
            float _e22 = irradia_probe_validity(_e18);
            validity = validity + (_e15 * _e22);
            total = total + _e15;
        }
    }
    return vec3((validity / max(total, 1e-30)));
}
