/** From our own 8-bit pictures back to light. */

/** Undoes the roll-off of `irradia.core.colour.picture_srgb8`, in linear display values. */
export function unshoulder(shown: number): number {
  return shown <= 0.5 ? shown : (1 - Math.log(2 * (1 - Math.min(shown, 0.9999)))) / 2;
}

/** Decodes IEC 61966-2-1. */
export function linearFromSrgb(coded: number): number {
  return coded <= 0.04045 ? coded / 12.92 : ((coded + 0.055) / 1.055) ** 2.4;
}
