// Generated from shaders/wgsl/probes-light.wgsl by `npm run shaders` in web/: don't edit.
// needs: probes, probe-cell
// given, in WGSL: var<uniform> irradia_probe_layout: array<vec4f>

float irradia_probe_share(float3 share, uint corner)
{
    bool3 high = bool3(((corner & 1u) != 0u), ((corner & 2u) != 0u), ((corner & 4u) != 0u));
    float3 along = high ? share : ((1.0).xxx - share);
    return (along.x * along.y) * along.z;
}

float3 irradia_light(float3 position, float3 normal, float3 surface_normal)
{
    float3 light = (0.0).xxx;
    float total = 0.0;
    bool local = (bool)0;

    const float4 _e3 = irradia_probe_cell(position);
    float on_surface = irradia_probe_layout[1].w;
    for (uint corner = 0u; corner < 8u; corner += 1u) {
        const float _e20 = irradia_probe_share(_e3.xyz, corner);
        const uint _e23 = irradia_probe_corner(_e3.w, corner);
        if (_e20 > 0.0) {
            local = _e23 != 4294967295u;
        } else {
            local = false;
        }
        if (local) {
            const float4 _e32 = irradia_probe_place(_e23);
            if (_e32.w > 0.0) {
                const float _e36 = irradia_probe_weight(_e23, _e32, position, surface_normal, on_surface);
                float weight = _e20 * _e36;
                const float3 _e39 = irradia_probe_irradiance(_e23, normal);
                light = light + (weight * _e39);
                total = total + weight;
            }
        }
    }
    return max((light / (max(total, 1e-30)).xxx), (0.0).xxx);
}

float3 irradia_view_validity(float3 position, float3 normal, float3 surface_normal)
{
    float validity = 0.0;
    float total = 0.0;

    const float4 _e3 = irradia_probe_cell(position);
    for (uint corner = 0u; corner < 8u; corner += 1u) {
        const float _e15 = irradia_probe_share(_e3.xyz, corner);
        const uint _e18 = irradia_probe_corner(_e3.w, corner);
        if (_e18 != 4294967295u) {
            const float _e22 = irradia_probe_validity(_e18);
            validity = validity + (_e15 * _e22);
            total = total + _e15;
        }
    }
    return ((validity / max(total, 1e-30))).xxx;
}
