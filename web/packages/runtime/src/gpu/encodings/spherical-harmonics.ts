import {
  legendreStart,
  normalisation,
  SphericalHarmonics,
} from "../../field/encodings/spherical-harmonics.js";
import type { EncodingShader, Vec4 } from "./encoding-shader.js";

export const sphericalHarmonicsShader: EncodingShader<SphericalHarmonics> = {
  type: SphericalHarmonics.type,
  piece: "spherical-harmonics",
  function: "irradia_spherical_harmonics",
  record({ degree }, { firstColumn }) {
    return [[firstColumn, degree, 0, 0], ...recurrences(degree)];
  },
  /** A product and a sum for each function. */
  cost: ({ nOutputs }) => ({ flops: 2 * nOutputs, fetches: 0 }),
};

/** Y's constant, and P_l = a z P_(l−1) − b P_(l−2) + c, with P_m = 1 of which the constant takes in the rest. */
function recurrences(degree: number): Vec4[] {
  const steps: Vec4[] = [];
  for (let m = 0; m < degree; m++) {
    for (let l = m; l < degree; l++) {
      const constant = normalisation(l, m) * legendreStart(m);
      const [a, b] = l > m ? [(2 * l - 1) / (l - m), (l + m - 1) / (l - m)] : [0, 0];
      steps.push([constant, a, b, l > m ? 0 : 1]);
    }
  }
  return steps;
}
