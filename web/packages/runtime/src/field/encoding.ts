/** What an encoding is: features of a point, computed in the readable way that shaders are held to. */

/** Three coordinates. */
export type Vec3 = readonly [number, number, number];

/** A named part of an encoding's parameters, as files store it; axes are row-major. */
export interface TensorSlot {
  readonly name: string;
  readonly shape: readonly number[];
}

/**
 * Turns points into features. Positions come in [0, 1]³, normals as unit vectors, both as floats; what is
 * learned comes as one array for each slot.
 */
export interface Encoding {
  /** As specs name it. */
  readonly type: string;
  /** `cube` wants inputs in [0, 1], so normals come as (n + 1) / 2; `any` takes them as they are. */
  readonly domain: "cube" | "any";
  /** Features a point. */
  readonly nOutputs: number;
  /** What it learns; empty where that is nothing. */
  readonly slots: readonly TensorSlot[];
  /** Writes the features of `x` to `out`, from place `first` on. */
  forward(x: Vec3, tensors: readonly Float32Array[], out: Float64Array, first: number): void;
}

/** Linear interpolation's weight of the corner 0 or 1 at a fraction of the way. */
export function cornerWeight(corner: number, fraction: number): number {
  return corner ? fraction : 1 - fraction;
}
