/** How far two pictures are apart, in numbers. */

/** Mean FLIP, and PSNR of coded values in decibels; Infinity for equal pictures. */
export interface Difference {
  readonly flip: number;
  readonly psnrDb: number;
}

/**
 * Means over the pixels where both sides show something.
 *
 * @param rgba FLIP, squared error, nothing, and 1 where both sides show something
 * @returns null where they have no pixel in common
 */
export function differenceOf(rgba: ArrayLike<number>): Difference | null {
  let [flip, squared, count] = [0, 0, 0];
  for (let i = 0; i + 3 < rgba.length; i += 4) {
    if ((rgba[i + 3] ?? 0) < 0.5) continue;
    flip += rgba[i] ?? 0;
    squared += rgba[i + 1] ?? 0;
    count += 1;
  }
  return count === 0 ? null : { flip: flip / count, psnrDb: -10 * Math.log10(squared / count) };
}
