/** Light probes as lists of words; `shaders/wgsl/probes.wgsl` reads them. */
import { planList, type TextureLimits, type TexturePlan } from "../gpu/texture.js";
import type { Probes } from "../scene/probes.js";
import type { ShaderTexture } from "./light-shader.js";

const WORDS_PER_PROBE = 20;
const N_COEFFICIENTS = 27;
const FIRST_COEFFICIENT = 8; // in halfs
const VALIDITY = 18; // in words

/** A list's texture: words, and zeros up to its end. */
export function listTexture(
  name: string,
  format: "r32uint" | "rgba32uint",
  words: Uint32Array,
  limits: TextureLimits,
): ShaderTexture {
  const plan = planList(format, words.length / (format === "r32uint" ? 1 : 4), limits, "probes");
  const data = new Uint32Array(plan.nBytes / 4);
  data.set(words);
  return { name, plan, data, access: "load" };
}

/** By how many bits to shift a texel's index for its row, and a row for its layer. */
export function listShifts({ width, height }: TexturePlan): [number, number] {
  return [Math.log2(width), Math.ceil(Math.log2(height))];
}

/** By probe: place and reach, which is negative where the probe doesn't count, coefficients, validity. */
export function probeRecords(probes: Probes): Uint32Array {
  const words = new Uint32Array(WORDS_PER_PROBE * probes.count);
  const [floats, halves] = [new Float32Array(words.buffer), new Uint16Array(words.buffer)];
  for (let probe = 0; probe < probes.count; probe++) {
    const first = WORDS_PER_PROBE * probe;
    for (let axis = 0; axis < 3; axis++) {
      const at = 3 * probe + axis;
      floats[first + axis] = (probes.positions[at] ?? 0) + (probes.offsets[at] ?? 0);
    }
    floats[first + 3] = probes.states[probe] === 0 ? (probes.reaches[probe] ?? 0) : -1;
    const coefficients = probes.coefficients.subarray(N_COEFFICIENTS * probe, N_COEFFICIENTS * (probe + 1));
    halves.set(coefficients, 2 * first + FIRST_COEFFICIENT);
    floats[first + VALIDITY] = probes.validities[probe] ?? 0;
  }
  return words;
}

/** Words of a probe's map. */
export function wordsPerMap({ size }: Probes["distances"]): number {
  return Math.ceil(size ** 2 / 2);
}

/** By probe its octahedral map, two texels a word. */
export function sightWords({ count, distances }: Probes): Uint32Array {
  const nWords = wordsPerMap(distances);
  const words = new Uint32Array(nWords * count);
  const [bytes, nBytes] = [new Uint8Array(words.buffer), 2 * distances.size ** 2];
  for (let probe = 0; probe < count; probe++) {
    bytes.set(distances.texels.subarray(nBytes * probe, nBytes * (probe + 1)), 4 * nWords * probe);
  }
  return words;
}
