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
    vec3 fractions = (positions - cells);
    for (uint plane = 0u; plane < 3u; plane += 1u) {
        uint _e40 = plane;
        uint _e44 = plane;
        uvec2 cell = uvec2(((_e44 > 0u) ? ((_e40 == 2u) ? cells.yz : cells.xz) : cells.xy));
        uint _e52 = plane;
        uint _e56 = plane;
        vec2 fraction = ((_e56 > 0u) ? ((_e52 == 2u) ? fractions.yz : fractions.xz) : fractions.xy);
        for (uint part = 0u; part < shape.w; part += 1u) {
            irradia_table_clear();
            for (uint corner = 0u; corner < 4u; corner += 1u) {
                uint _e70 = corner;
                uint _e73 = corner;
                uvec2 far = uvec2((_e70 & 1u), (_e73 >> 1u));
                vec2 side = mix((vec2(1.0) - fraction), fraction, equal(far, uvec2(1u)));
                uvec2 at = (cell + far);
                uint _e85 = plane;
                float _e93 = irradia_table_scale(scales[_e85], (((at.y * size) + at.x) >> scales.w));
                uint _e94 = plane;
                uint _e97 = part;
                uvec4 _e101 = irradia_table_texel(uvec3(at, ((_e94 * shape.w) + _e97)), 0u);
                irradia_table_add(_e101, ((side.x * side.y) * _e93));
            }
            uint _e110 = plane;
            uint _e114 = part;
            uint _e119 = part;
            irradia_table_push(((shape.x + (_e110 * shape.y)) + (_e114 * shape.z)), (shape.y - (_e119 * shape.z)));
        }
    }
    return;
}
