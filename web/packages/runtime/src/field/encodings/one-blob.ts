import type { JsonView } from "../../json.js";
import { clamp } from "../../numbers.js";
import type { Encoding, TensorSlot, Vec3 } from "../encoding.js";

/**
 * How much of a bump of radius 1 / bins, centred on a coordinate, lies in each bin of [0, 1]; coordinate by
 * coordinate, then by bin (Müller et al. 2019, section 4.3, with tiny-cuda-nn's quartic; no wrap from 1 to 0).
 */
export class OneBlob implements Encoding {
  static readonly type = "one_blob";
  readonly type = OneBlob.type;
  readonly domain = "cube";
  readonly slots: readonly TensorSlot[] = [];
  readonly nBins: number;
  readonly nOutputs: number;

  constructor(nBins: number) {
    this.nBins = nBins;
    this.nOutputs = 3 * nBins;
  }

  static read(spec: JsonView): OneBlob {
    spec.allow(["type", "n_bins"]);
    return new OneBlob(spec.integer("n_bins", 1, 128, 16));
  }

  forward(x: Vec3, _tensors: readonly Float32Array[], out: Float64Array, first: number): void {
    let at = first;
    for (const coordinate of x) {
      const centre = coordinate * this.nBins;
      for (let bin = 0; bin < this.nBins; bin++) {
        out[at++] = shareBelow(bin + 1 - centre) - shareBelow(bin - centre);
      }
    }
  }
}

/** ∫ 15/16 (1 − u²)² from −1; 0 below and 1 above ±1. */
function shareBelow(edge: number): number {
  const u = clamp(edge, -1, 1);
  const square = u * u;
  return 0.5 + (15 / 16) * u * (1 - (2 / 3) * square + 0.2 * square * square);
}
