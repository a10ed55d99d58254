/** Fills the textures that `planFieldTextures` planned. */
import { type Field, tensorOf } from "../field/field.js";
import { extentOf } from "../field/spec.js";
import { bitsPerValue, codeAt, scaleAt, storedBytes, type Tensor, tensorValues } from "../field/tensor.js";
import { product } from "../numbers.js";
import { type ConstantsPlan, placeOf } from "./constants.js";
import type { Vec4 } from "./encodings/encoding-shader.js";
import { encodingShader } from "./encodings/registry.js";
import type { FieldTextures, TableTexture } from "./field-textures.js";
import { packHalfWeights } from "./half-weights.js";
import { encodingLeaves } from "./leaves.js";
import type { TexturePlan } from "./texture.js";

const WORDS = { r32uint: 1, rg32uint: 2, rgba32uint: 4 } as const;

/** What to upload, layer by layer, row by row. */
export interface PackedField {
  /** Words of each of the plan's tables. */
  readonly tables: readonly Uint32Array[];
  /** All vec4s; as long as the plan's texture where it has one. */
  readonly constants: Float32Array;
  /** In half precision: words of the plan's weights. */
  readonly weights?: Uint32Array;
}

/** Packs a field's weights as its plan says. */
export function packField(field: Field, plan: FieldTextures): PackedField {
  return {
    tables: plan.tables.map((table) => packTable(field, table)),
    constants: packConstants(field, plan),
    ...(plan.constants.weights ? { weights: packHalfWeights(field, plan.constants) } : {}),
  };
}

/** Words of a texel. */
export function wordsPerTexel({ format }: TexturePlan): number {
  return format in WORDS ? WORDS[format as keyof typeof WORDS] : 4;
}

/** Word and bit at which an entry of a tensor begins. */
export function entryPlace(
  table: TableTexture,
  firstTexel: number,
  entry: number,
): { word: number; bit: number } {
  const { texture, entry: layout } = table;
  const nWords = wordsPerTexel(texture);
  if (table.layout === "planes") {
    const texels = texture.width * texture.height;
    const layer = Math.floor(entry / texels) * layout.texelsPerEntry;
    return { word: (layer * texels + (entry % texels)) * nWords, bit: 0 };
  }
  const texel = firstTexel + Math.floor(entry / layout.entriesPerTexel) * layout.texelsPerEntry;
  return { word: texel * nWords, bit: (entry % layout.entriesPerTexel) * layout.entryBits };
}

/** Words from one texel of an entry to the next; in planes they are a layer apart. */
export function texelStride({ texture, layout }: TableTexture): number {
  return wordsPerTexel(texture) * (layout === "planes" ? texture.width * texture.height : 1);
}

function packTable(field: Field, table: TableTexture): Uint32Array {
  const words = new Uint32Array(table.texture.nBytes / 4);
  for (const { tensor: name, firstTexel } of table.tensors) {
    const tensor = tensorOf(field, name);
    if (isVerbatim(tensor, table)) {
      const first = 4 * firstTexel * wordsPerTexel(table.texture);
      new Uint8Array(words.buffer).set(storedBytes(tensor), first);
    } else packEntries(words, table, tensor, firstTexel);
  }
  return words;
}

/** Whether the texture holds the very bytes of the file: nothing is padded, converted, or in other layers. */
function isVerbatim(tensor: Tensor, { entry, layout }: TableTexture): boolean {
  const isFull = entry.nFeatures * entry.bits === entry.entryBits && bitsPerValue(tensor) === entry.bits;
  return isFull && (layout === "list" || (entry.entryBits >= 32 && entry.texelsPerEntry === 1));
}

function packEntries(words: Uint32Array, table: TableTexture, tensor: Tensor, firstTexel: number): void {
  const { bits, nFeatures } = table.entry;
  const [nWords, stride] = [wordsPerTexel(table.texture), texelStride(table)];
  const bitsOf = bitsReader(tensor, bits);
  const nEntries = product(tensor.shape.slice(0, -1));
  for (let entry = 0; entry < nEntries; entry++) {
    const { word, bit } = entryPlace(table, firstTexel, entry);
    for (let f = 0; f < nFeatures; f++) {
      const at = bit + f * bits;
      const [texel, inTexel] = [Math.floor(at / (32 * nWords)), Math.floor(at / 32) % nWords];
      const place = word + texel * stride + inTexel;
      words[place] = (words[place] ?? 0) | (bitsOf(entry * nFeatures + f) << (at % 32));
    }
  }
}

/** The bits of a tensor's values, as so many. */
function bitsReader(tensor: Tensor, bits: number): (index: number) => number {
  const { stored } = tensor;
  if (stored.kind === "codes" && bits === 8) return (i) => codeAt(stored, i) & 255;
  if (stored.kind === "codes" && bits === 4) return (i) => codeAt(stored, i) + 8;
  if (stored.kind === "half" && bits === 16) return (i) => stored.bits[i] ?? 0;
  const values = new Uint32Array(Float32Array.from(tensorValues(tensor)).buffer);
  return (i) => values[i] ?? 0;
}

function packConstants(field: Field, plan: FieldTextures): Float32Array {
  const { constants } = plan;
  const numbers = new Float32Array((constants.texture?.nBytes ?? 16 * constants.nVec4) / 4);
  numbers.set(header(field, constants).flat());
  packPerceptron(numbers, field, constants);
  packScales(numbers, field, plan);
  encodingLeaves(field.spec).forEach((leaf, i) => {
    const place = placeOf(leaf, plan.tables, constants.scalesVec4);
    const record = encodingShader(leaf.encoding).record(leaf.encoding, place);
    numbers.set(record.flat(), 4 * (constants.records[i] ?? 0));
  });
  return numbers;
}

/** What all fields have; `shaders/wgsl/field.wgsl` reads it. */
function header({ spec, frame }: Field, { layers }: ConstantsPlan): Vec4[] {
  const [first, second, last] = [layers[0], layers[1], layers.at(-1)];
  if (!first || !second || !last) throw new Error("a perceptron has at least two matrices");
  const [x, y, z] = extentOf(frame);
  return [
    [...frame.min, frame.scale],
    [x, y, z, spec.nHiddenLayers],
    [first.firstWeight, 4 * first.blocksIn, first.firstBias, second.firstWeight],
    [last.firstWeight, last.firstBias, 0, 0],
  ];
}

function packPerceptron(numbers: Float32Array, field: Field, { layers, weights }: ConstantsPlan): void {
  layers.forEach(({ nInputs, nOutputs, blocksIn, firstWeight, firstBias }, i) => {
    numbers.set(tensorValues(tensorOf(field, `mlp.${i}.bias`)), 4 * firstBias);
    if (weights) return;
    const weight = tensorValues(tensorOf(field, `mlp.${i}.weight`));
    for (let row = 0; row < nOutputs; row++) {
      for (let column = 0; column < nInputs; column++) {
        const block = Math.floor(row / 4) * blocksIn + Math.floor(column / 4);
        const vec4 = firstWeight + 4 * block + (column % 4);
        numbers[4 * vec4 + (row % 4)] = weight[row * nInputs + column] ?? 0;
      }
    }
  });
}

function packScales(numbers: Float32Array, field: Field, { constants, tables }: FieldTextures): void {
  for (const { tensor, firstScale } of tables.flatMap((table) => table.tensors)) {
    const { stored } = tensorOf(field, tensor);
    if (stored.kind !== "codes" || firstScale < 0) continue;
    const first = 4 * constants.scalesVec4 + firstScale;
    for (let block = 0; block < stored.scales.length; block++)
      numbers[first + block] = scaleAt(stored, block);
  }
}
