// Generated from shaders/wgsl/cosine-lobe.wgsl by `npm run shaders` in web/: don't edit.

float4 irradia_lobe_linear(float3 n)
{
    return float4(0.88622695, (1.0233268 * n.yzx));
}

float4 irradia_lobe_quadratic(float3 n)
{
    return float4(((0.8580855 * n.x) * n.y), ((0.8580855 * n.y) * n.z), (0.24770796 * (((3.0 * n.z) * n.z) - 1.0)), ((0.8580855 * n.x) * n.z));
}

float irradia_lobe_squares(float3 n)
{
    return 0.42904276 * ((n.x * n.x) - (n.y * n.y));
}
