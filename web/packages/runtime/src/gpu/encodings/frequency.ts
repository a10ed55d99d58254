import { Frequency } from "../../field/encodings/frequency.js";
import type { EncodingShader } from "./encoding-shader.js";

export const frequencyShader: EncodingShader<Frequency> = {
  type: Frequency.type,
  piece: "frequency",
  function: "irradia_frequency",
  record({ nFrequencies, includeIdentity }, { firstColumn }) {
    return [[firstColumn, nFrequencies, includeIdentity ? 1 : 0, 0]];
  },
  /** An angle, then its sine and cosine. */
  cost: ({ nFrequencies }) => ({ flops: 3 * nFrequencies * 3, fetches: 0 }),
};
