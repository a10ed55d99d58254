// A plain lightmap: one texel of E/π says it all.

// E of a texel; `scale` is the map's, times π.
fn irradia_lightmap_irradiance(texel: vec3f, scale: f32) -> vec3f {
    return max(texel * scale, vec3f(0.0));
}
