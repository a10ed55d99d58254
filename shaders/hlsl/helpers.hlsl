// Generated from shaders/wgsl/ by `npm run shaders` in web/: don't edit.
// Comes before all pieces.

uint naga_f2u32(float value) {
    return uint(clamp(value, 0.0, 4294967000.0));
}

uint naga_mod(uint lhs, uint rhs) {
    return lhs % (rhs == 0u ? 1u : rhs);
}

uint2 naga_f2u32(float2 value) {
    return uint2(clamp(value, 0.0, 4294967000.0));
}

uint3 naga_f2u32(float3 value) {
    return uint3(clamp(value, 0.0, 4294967000.0));
}

uint4 naga_f2u32(float4 value) {
    return uint4(clamp(value, 0.0, 4294967000.0));
}
