/** Where the numbers of a field lie that aren't in tables: one list of vec4s. */
import type { Field } from "../field/field.js";
import { layerShapes } from "../field/spec.js";
import type { EncodingPlace } from "./encodings/encoding-shader.js";
import { encodingShader } from "./encodings/registry.js";
import type { TableTexture } from "./field-textures.js";
import type { EncodingLeaf } from "./leaves.js";
import { planTexture, type TextureFormat, type TextureLimits, type TexturePlan } from "./texture.js";

/**
 * One matrix of the perceptron, in blocks of 4 × 4; missing rows and columns are zeros. Hidden layers are padded
 * to a width that shaders have, `PADDED_WIDTHS`.
 */
export interface LayerPlacement {
  readonly nInputs: number;
  readonly nOutputs: number;
  /** Blocks side by side, for the inputs, and one below another, for the outputs. */
  readonly blocksIn: number;
  readonly blocksOut: number;
  /**
   * Column c of block (i outputs, j inputs), both by fours: vec4 `firstWeight + 4 (i · blocksIn + j) + c`. In half
   * precision the first texel of the weights' own list; see `gpu/half-weights.ts`.
   */
  readonly firstWeight: number;
  /** Biases of outputs 4 i to 4 i + 3: vec4 `firstBias + i`. */
  readonly firstBias: number;
}

/** The list of vec4s. */
export interface ConstantsPlan {
  readonly nVec4: number;
  readonly layers: readonly LayerPlacement[];
  /** Where scales begin: scale s is component s mod 4 of vec4 `scalesVec4 + ⌊s / 4⌋`. */
  readonly scalesVec4: number;
  readonly nScales: number;
  /** First vec4 of each encoding's record, in the order of `encodingLeaves`. */
  readonly records: readonly number[];
  /** Absent where the list fits a uniform buffer. Otherwise rgba32float, 256 columns, row by row. */
  readonly texture?: TexturePlan;
  /** In half precision: weights as half floats, rgba32uint, 256 columns, row by row. */
  readonly weights?: TexturePlan;
}

/** What weights are on the GPU, and what hidden layers hand on: floats, or half floats. Sums are floats. */
export type Precision = "float" | "half";

/** Of hidden layers in shaders; others are padded with zeros to the next. */
export const PADDED_WIDTHS = [16, 32, 64, 128] as const;

/** Vec4s before the perceptron. */
const HEADER = 4;
const COLUMNS = 256;

/**
 * Plans the list: what all fields have (`shaders/wgsl/field.wgsl` says which four), the perceptron in floats,
 * the scales of codes, and a record of each encoding.
 *
 * @throws InputError where it fits neither a uniform buffer nor a texture
 */
export function planConstants(
  field: Field,
  leaves: readonly EncodingLeaf[],
  tables: readonly TableTexture[],
  nScales: number,
  limits: TextureLimits,
  precision: Precision,
): ConstantsPlan {
  const { layers, end: scalesVec4, nWeightTexels } = placeLayers(field, precision === "half");
  let next = scalesVec4 + Math.ceil(nScales / 4);
  const records = leaves.map((leaf) => {
    const first = next;
    next += encodingShader(leaf.encoding).record(leaf.encoding, placeOf(leaf, tables, scalesVec4)).length;
    return first;
  });
  const fits = 16 * next <= limits.maxUniformBytes;
  const list = (format: TextureFormat, count: number): TexturePlan =>
    planTexture(format, [COLUMNS, Math.ceil(count / COLUMNS), 1], limits, "perceptron");
  return {
    nVec4: next,
    layers,
    scalesVec4,
    nScales,
    records,
    ...(fits ? {} : { texture: list("rgba32float", next) }),
    ...(nWeightTexels ? { weights: list("rgba32uint", nWeightTexels) } : {}),
  };
}

/** Where an encoding's parts are, for its record. */
export function placeOf(
  leaf: EncodingLeaf,
  tables: readonly TableTexture[],
  scalesVec4: number,
): EncodingPlace {
  const table = tables.find(({ owner }) => owner === leaf.owner);
  return { firstColumn: leaf.firstColumn, table, firstScale: 4 * scalesVec4 };
}

/** The width that shaders take for a hidden layer. */
export function paddedWidth({ spec }: Field): (typeof PADDED_WIDTHS)[number] {
  return PADDED_WIDTHS.find((width) => width >= spec.width) ?? 128;
}

/**
 * Matrices one behind another, each before its biases; of a perceptron in half precision biases alone, and matrices
 * one behind another in a list of their own, two columns of a block in a texel.
 */
function placeLayers(
  field: Field,
  isHalf: boolean,
): { layers: LayerPlacement[]; end: number; nWeightTexels: number } {
  const shapes = layerShapes(field.spec);
  const hidden = paddedWidth(field) / 4;
  let [end, nWeightTexels] = [HEADER, 0];
  const layers = shapes.map(({ nInputs, nOutputs }, i) => {
    const blocksIn = i ? hidden : Math.ceil(nInputs / 4);
    const blocksOut = i < shapes.length - 1 ? hidden : Math.ceil(nOutputs / 4);
    const nColumns = 4 * blocksIn * blocksOut;
    const firstWeight = isHalf ? nWeightTexels : end;
    if (isHalf) nWeightTexels += nColumns / 2;
    else end += nColumns;
    const firstBias = end;
    end += blocksOut;
    return { nInputs, nOutputs, blocksIn, blocksOut, firstWeight, firstBias };
  });
  return { layers, end, nWeightTexels };
}
