/** Automatic exposure, as `irradia.core.colour.automatic_exposure_ev` does it. */

const MIDDLE_GREY = 0.18;

/**
 * Stops that show linear pixels well: the geometric mean of the luminances above 0 becomes middle grey.
 *
 * @param rgba linear Rec.709, four numbers a pixel; pixels of alpha 0 are left out
 * @returns 0 for black pictures
 */
export function automaticEv(rgba: ArrayLike<number>): number {
  let sum = 0;
  let count = 0;
  for (let i = 0; i + 3 < rgba.length; i += 4) {
    const luminance = 0.2126 * (rgba[i] ?? 0) + 0.7152 * (rgba[i + 1] ?? 0) + 0.0722 * (rgba[i + 2] ?? 0);
    if (!((rgba[i + 3] ?? 0) > 0) || !(luminance > 0) || !Number.isFinite(luminance)) continue;
    sum += Math.log2(luminance);
    count += 1;
  }
  return count === 0 ? 0 : Math.log2(MIDDLE_GREY) - sum / count;
}

/** `+1.3 EV`. */
export function stops(ev: number): string {
  const rounded = Math.round(ev * 10) / 10;
  return `${rounded < 0 ? "−" : "+"}${Math.abs(rounded).toFixed(1)} EV`;
}
