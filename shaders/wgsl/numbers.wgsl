// Whole numbers among floats.

// A number below 2³² from its lower and upper 16 bits: a float alone is exact only up to 2²⁴.
fn irradia_whole(parts: vec2f) -> u32 {
    return u32(parts.x) | (u32(parts.y) << 16u);
}
