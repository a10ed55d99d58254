/** Irradiance from spherical harmonics of radiance; order and signs are those of docs/conventions.md. */
import type { Vec3 } from "./encoding.js";

const C0 = 0.5 * Math.sqrt(1 / Math.PI); // 0.282095
const C1 = Math.sqrt(3 / (4 * Math.PI)); // 0.488603
const C2 = 0.5 * Math.sqrt(15 / Math.PI); // 1.092548
const C20 = 0.25 * Math.sqrt(5 / Math.PI); // 0.315392
const C22 = 0.25 * Math.sqrt(15 / Math.PI); // 0.546274
/** The cosine lobe by band (Ramamoorthi and Hanrahan 2001, equation 8). */
const LOBE = [Math.PI, (2 * Math.PI) / 3, Math.PI / 4] as const;

/** Nine weights whose sum with coefficients of radiance is E on a surface of a unit normal. */
export function irradianceWeights([x, y, z]: Vec3): number[] {
  const [a0, a1, a2] = LOBE;
  return [
    a0 * C0,
    a1 * C1 * y,
    a1 * C1 * z,
    a1 * C1 * x,
    a2 * C2 * x * y,
    a2 * C2 * y * z,
    a2 * C20 * (3 * z * z - 1),
    a2 * C2 * x * z,
    a2 * C22 * (x * x - y * y),
  ];
}

/** E in RGB, never negative, from 4 or 9 coefficients × 3 channels, (coefficient, channel) flattened. */
export function irradianceOf(coefficients: ArrayLike<number>, normal: Vec3): [number, number, number] {
  const weights = irradianceWeights(normal);
  const sum: [number, number, number] = [0, 0, 0];
  for (let i = 0; i < coefficients.length; i++) {
    const channel = (i % 3) as 0 | 1 | 2;
    sum[channel] += (weights[Math.floor(i / 3)] ?? 0) * (coefficients[i] ?? 0);
  }
  return [Math.max(sum[0], 0), Math.max(sum[1], 0), Math.max(sum[2], 0)];
}
