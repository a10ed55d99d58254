import type { JsonView } from "../../json.js";
import { roundHalfEven } from "../../numbers.js";
import type { Encoding, TensorSlot, Vec3 } from "../encoding.js";

export interface FrequencyOptions {
  /** Of each coordinate. */
  nFrequencies: number;
  /** Whether the coordinates themselves are features too. */
  includeIdentity: boolean;
}

/**
 * sin and cos of 2^k · π · x, for k from 0; coordinate by coordinate, then by k, then sin before cos
 * (Mildenhall et al. 2020, equation 4). With `includeIdentity` x, y and z come before all of them.
 */
export class Frequency implements Encoding {
  static readonly type = "frequency";
  readonly type = Frequency.type;
  readonly domain = "cube";
  readonly slots: readonly TensorSlot[] = [];
  readonly nFrequencies: number;
  readonly includeIdentity: boolean;
  readonly nOutputs: number;

  constructor(options: FrequencyOptions) {
    this.nFrequencies = options.nFrequencies;
    this.includeIdentity = options.includeIdentity;
    this.nOutputs = 6 * this.nFrequencies + (this.includeIdentity ? 3 : 0);
  }

  static read(spec: JsonView): Frequency {
    spec.allow(["type", "n_frequencies", "include_identity"]);
    return new Frequency({
      nFrequencies: spec.integer("n_frequencies", 1, 24, 10),
      includeIdentity: spec.boolean("include_identity", false),
    });
  }

  /**
   * The argument is brought into ±π while it still is a multiple of π: doubling a float is exact and so is
   * taking the nearest even number away. Shaders have to do the same.
   */
  forward(x: Vec3, _tensors: readonly Float32Array[], out: Float64Array, first: number): void {
    let at = first;
    if (this.includeIdentity) for (const coordinate of x) out[at++] = coordinate;
    for (const coordinate of x) {
      for (let k = 0; k < this.nFrequencies; k++) {
        const halfTurns = coordinate * 2 ** k;
        const angle = Math.PI * (halfTurns - 2 * roundHalfEven(halfTurns / 2));
        out[at++] = Math.sin(angle);
        out[at++] = Math.cos(angle);
      }
    }
  }
}
