import type { JsonView } from "../../json.js";
import { clamp } from "../../numbers.js";
import { cornerWeight, type Encoding, type TensorSlot, type Vec3 } from "../encoding.js";

/** xy, xz and yz: the axes along columns and along rows. */
const PLANES = [
  [0, 1],
  [0, 2],
  [1, 2],
] as const;

/** Of a cell: steps along columns and rows. */
const CORNERS = [
  [0, 0],
  [1, 0],
  [0, 1],
  [1, 1],
] as const;

export interface TriPlaneOptions {
  /** Texels along each side of a plane. */
  resolution: number;
  /** Of each plane. */
  nFeatures: number;
  /** Texel centres are at i / (resolution − 1), not at (i + ½) / resolution. */
  alignCorners: boolean;
}

/**
 * Bilinear lookups in three learned images along the box's axes, their features one after another. Texels
 * lie as (plane, row, column, feature); edges are clamped.
 */
export class TriPlane implements Encoding {
  static readonly type = "triplane";
  readonly type = TriPlane.type;
  readonly domain = "cube";
  readonly resolution: number;
  readonly nFeatures: number;
  readonly alignCorners: boolean;
  readonly nOutputs: number;
  readonly slots: readonly TensorSlot[];

  constructor(options: TriPlaneOptions) {
    this.resolution = options.resolution;
    this.nFeatures = options.nFeatures;
    this.alignCorners = options.alignCorners;
    this.nOutputs = PLANES.length * this.nFeatures;
    const shape = [PLANES.length, this.resolution, this.resolution, this.nFeatures];
    this.slots = [{ name: "planes", shape }];
  }

  static read(spec: JsonView): TriPlane {
    spec.allow(["type", "resolution", "n_features", "align_corners"]);
    return new TriPlane({
      resolution: spec.integer("resolution", 2, 8192, 128),
      nFeatures: spec.integer("n_features", 1, 128, 16),
      alignCorners: spec.boolean("align_corners", false),
    });
  }

  /** Texel coordinates, whole at centres, are `scale * x + offset`. */
  get texelFromUnit(): { scale: number; offset: number } {
    if (this.alignCorners) return { scale: this.resolution - 1, offset: 0 };
    return { scale: this.resolution, offset: -0.5 };
  }

  forward(x: Vec3, tensors: readonly Float32Array[], out: Float64Array, first: number): void {
    const planes = tensors[0] as Float32Array;
    const positions = x.map((coordinate) => this.#texel(coordinate));
    out.fill(0, first, first + this.nOutputs);
    PLANES.forEach(([across, down], plane) => {
      const [u, v] = [positions[across] as number, positions[down] as number];
      // The last texel is the end of the last cell.
      const column = Math.min(Math.floor(u), this.resolution - 2);
      const row = Math.min(Math.floor(v), this.resolution - 2);
      for (const [i, j] of CORNERS) {
        const weight = cornerWeight(i, u - column) * cornerWeight(j, v - row);
        const texel = (plane * this.resolution + row + j) * this.resolution + column + i;
        for (let f = 0; f < this.nFeatures; f++) {
          const place = first + plane * this.nFeatures + f;
          out[place] = (out[place] ?? 0) + weight * (planes[texel * this.nFeatures + f] ?? 0);
        }
      }
    });
  }

  /** Rounded as floats round it. */
  #texel(coordinate: number): number {
    const { scale, offset } = this.texelFromUnit;
    return clamp(Math.fround(Math.fround(scale * coordinate) + offset), 0, this.resolution - 1);
  }
}
