// Generated from shaders/wgsl/tri-plane.wgsl by `npm run shaders` in web/: don't edit.
// needs: value

void irradia_table_tri_plane(uint record, vec3 unit) {
    vec4 _e2 = irradia_constant(record);
    uvec4 shape = uvec4(_e2);
    vec4 _e6 = irradia_constant((record + 1u));
    vec4 _e9 = irradia_constant((record + 2u));
    uvec4 scales = uvec4(_e9);
    uint size = uint(_e6.z);
    vec3 positions = clamp(((_e6.x * unit) + vec3(_e6.y)), vec3(0.0), vec3((_e6.z - 1.0)));
    vec3 cells = min(floor(positions), vec3((_e6.z - 2.0)));
    vec3 fractions = positions - cells;
    for (uint plane = 0u; plane < 3u; plane += 1u) {
        uvec2 cell = uvec2(((plane > 0u) ? ((plane == 2u) ? cells.yz : cells.xz) : cells.xy));
        vec2 fraction = (plane > 0u) ? ((plane == 2u) ? fractions.yz : fractions.xz) : fractions.xy;
        for (uint part = 0u; part < shape.w; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 4u; corner += 1u) {
                uvec2 far = uvec2((corner & 1u), (corner >> 1u));
                vec2 side = mix((vec2(1.0) - fraction), fraction, equal(far, uvec2(1u)));
                uvec2 at = cell + far;
                float _e93 = irradia_table_scale(scales[plane], (((at.y * size) + at.x) >> scales.w));
                uvec4 _e101 = irradia_table_texel(uvec3(at, ((plane * shape.w) + part)), 0u);
                irradia_table_add(_e101, ((side.x * side.y) * _e93));
            }
            irradia_table_push(((shape.x + (plane * shape.y)) + (part * shape.z)), (shape.y - (part * shape.z)));
        }
    }
}
