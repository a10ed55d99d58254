import type { JsonView } from "../../json.js";
import type { Encoding, TensorSlot, Vec3 } from "../encoding.js";

const MAX_DEGREE = 5;

/**
 * Y_lm of the direction 2x − 1 for l below `degree`, by l and then m from −l to l; real, every constant
 * positive. Directions are taken to have unit length.
 */
export class SphericalHarmonics implements Encoding {
  static readonly type = "sh";
  readonly type = SphericalHarmonics.type;
  readonly domain = "cube";
  readonly slots: readonly TensorSlot[] = [];
  /** Bands, so 4 has l from 0 to 3. */
  readonly degree: number;
  readonly nOutputs: number;

  constructor(degree: number) {
    this.degree = degree;
    this.nOutputs = degree * degree;
  }

  static read(spec: JsonView): SphericalHarmonics {
    spec.allow(["type", "degree"]);
    return new SphericalHarmonics(spec.integer("degree", 1, MAX_DEGREE, 4));
  }

  forward(v: Vec3, _tensors: readonly Float32Array[], out: Float64Array, first: number): void {
    const [x, y, z] = [2 * v[0] - 1, 2 * v[1] - 1, 2 * v[2] - 1];
    // cos mφ and sin mφ times sin^m θ, which the Legendre part below leaves out.
    let [cosine, sine] = [1, 0];
    for (let m = 0; m < this.degree; m++) {
      legendre(this.degree, m, z).forEach((polynomial, step) => {
        const l = m + step;
        const value = normalisation(l, m) * polynomial;
        const centre = first + l * (l + 1);
        out[centre + m] = value * cosine;
        if (m) out[centre - m] = value * sine;
      });
      [cosine, sine] = [x * cosine - y * sine, x * sine + y * cosine];
    }
  }
}

/** What makes Y_lm orthonormal, for m ≥ 0. */
export function normalisation(l: number, m: number): number {
  const ratio = factorial(l - m) / factorial(l + m);
  return Math.sqrt(((2 * l + 1) / (4 * Math.PI)) * ratio * (m ? 2 : 1));
}

function factorial(n: number): number {
  return n < 2 ? 1 : n * factorial(n - 1);
}

/** P_m^m / sin^m θ without Condon and Shortley's sign: the product of odd numbers below 2m. */
export function legendreStart(m: number): number {
  return m ? (2 * m - 1) * legendreStart(m - 1) : 1;
}

/** P_l^m(z) / sin^m θ without Condon and Shortley's sign, for l from m to degree − 1. */
function legendre(degree: number, m: number, z: number): number[] {
  let before = 0;
  let last = legendreStart(m);
  const found = [last];
  for (let l = m + 1; l < degree; l++) {
    const next = ((2 * l - 1) * z * last - (l + m - 1) * before) / (l - m);
    [before, last] = [last, next];
    found.push(next);
  }
  return found;
}
