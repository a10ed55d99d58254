/**
 * Which tensor of a field goes where on the GPU.
 *
 * **Tables** (of hash grids and planes) become textures of unsigned words, one for each encoding that learns:
 * the same bits that the file holds, so that half floats, bytes and nibbles cost on the GPU what they cost on
 * disk, and one shader decodes them all. They are read with `textureLoad` and filtered by hand. Formats that
 * texture units decode (rg16float, rg8snorm) would need a shader variant each, and no format has nibbles.
 *
 * An *entry* is the features of one corner or texel. Its features are padded with unused ones to a power of
 * two, so that entries never straddle words; feature f of an entry begins at bit f · bits, the first at the
 * lowest.
 *
 * **Constants** are one list of vec4s with all other numbers. It fits a uniform buffer in most cases, else a
 * texture.
 */
import { TriPlane } from "../field/encodings/tri-plane.js";
import { type Field, tensorOf } from "../field/field.js";
import { bitsPerValue, type Tensor } from "../field/tensor.js";
import { isPowerOfTwo, product } from "../numbers.js";
import { type ConstantsPlan, type Precision, planConstants } from "./constants.js";
import { type EncodingLeaf, encodingLeaves } from "./leaves.js";
import {
  planList,
  planTexture,
  type TextureFormat,
  type TextureLimits,
  type TexturePlan,
} from "./texture.js";

/** Bits of a value in a table: nibbles plus 8, signed bytes, half floats, floats. */
export type TableBits = 4 | 8 | 16 | 32;

/** How entries lie in words and texels. */
export interface EntryLayout {
  readonly bits: TableBits;
  /** Features of an entry that mean something. */
  readonly nFeatures: number;
  /** Bits of an entry, a power of two from 4 up. */
  readonly entryBits: number;
  /** Entries of a texel, a power of two; 1 in planes. */
  readonly entriesPerTexel: number;
  /** Texels of an entry, a power of two; 1 unless an entry has over 128 bits. */
  readonly texelsPerEntry: number;
}

/** One tensor in its texture. */
export interface TablePlacement {
  /** As files name it. */
  readonly tensor: string;
  /** In a list: its first texel. In planes 0. */
  readonly firstTexel: number;
  /** Its first among the scales of all tables; −1 where it has no codes. */
  readonly firstScale: number;
  /** Values that share a scale: value v of the unpadded tensor has scale `firstScale + ⌊v / block⌋`. */
  readonly block: number;
}

/** The texture of one encoding's tables. */
export interface TableTexture {
  /** Such as `position`, or `position.1` for the second part of a composite. */
  readonly owner: string;
  /**
   * `list`: entry e begins at texel `firstTexel + ⌊e / entriesPerTexel⌋ · texelsPerEntry`; see `planList`.
   * `planes`: entry (plane, row, column) is at x = column, y = row, layer = plane · texelsPerEntry, and its
   * further texels are in the next layers.
   */
  readonly layout: "list" | "planes";
  readonly texture: TexturePlan;
  readonly entry: EntryLayout;
  readonly tensors: readonly TablePlacement[];
}

/** All that a shader needs to find a field's weights. */
export interface FieldTextures {
  readonly tables: readonly TableTexture[];
  readonly constants: ConstantsPlan;
}

/**
 * Plans a field's textures; nothing is allocated.
 *
 * @throws InputError where the field is too large for the device
 */
export function planFieldTextures(
  field: Field,
  limits: TextureLimits,
  precision: Precision = "float",
): FieldTextures {
  let nScales = 0;
  const leaves = encodingLeaves(field.spec);
  const tables = leaves
    .filter(({ encoding }) => encoding.slots.length)
    .map((leaf) => {
      const table = planTable(field, leaf, nScales, limits);
      for (const placed of table.tensors) nScales += scaleCount(field, placed);
      return table;
    });
  return { tables, constants: planConstants(field, leaves, tables, nScales, limits, precision) };
}

function planTable(
  field: Field,
  { owner, encoding }: EncodingLeaf,
  firstScale: number,
  limits: TextureLimits,
): TableTexture {
  const names = encoding.slots.map((slot) => `${owner}.${slot.name}`);
  const nFeatures = encoding.slots[0]?.shape.at(-1) ?? 1;
  const isPlanes = encoding instanceof TriPlane;
  const tensorsOfAll = names.map((name) => tensorOf(field, name));
  const bits = tensorsOfAll.every((tensor) => hasEasyScales(tensor, isPlanes))
    ? commonBits(tensorsOfAll)
    : 32;
  const { entry, format } = planEntry(bits, nFeatures, isPlanes);
  const { tensors, nTexels } = placeTensors(field, names, entry, firstScale);
  const texture = isPlanes
    ? planTexture(format, [encoding.resolution, encoding.resolution, 3 * entry.texelsPerEntry], limits, owner)
    : planList(format, nTexels, limits, owner);
  return { owner, layout: isPlanes ? "planes" : "list", texture, entry, tensors };
}

/** Tensors one behind another, each on a whole texel, and so their scales. */
function placeTensors(
  field: Field,
  names: readonly string[],
  entry: EntryLayout,
  scalesBefore: number,
): { tensors: TablePlacement[]; nTexels: number } {
  let [nTexels, nScales] = [0, scalesBefore];
  const tensors = names.map((tensor) => {
    const { shape, stored } = tensorOf(field, tensor);
    const isCoded = stored.kind === "codes" && stored.bits === entry.bits;
    const scales = isCoded ? { firstScale: nScales, block: stored.block } : { firstScale: -1, block: 0 };
    const placed = { tensor, firstTexel: nTexels, ...scales };
    const nEntries = product(shape.slice(0, -1));
    nTexels += Math.ceil(nEntries / entry.entriesPerTexel) * entry.texelsPerEntry;
    nScales += scaleCount(field, placed);
    return placed;
  });
  return { tensors, nTexels };
}

/** What all tensors are stored in, or floats where they differ. */
function commonBits(tensors: readonly Tensor[]): TableBits {
  const kinds = new Set(tensors.map(bitsPerValue));
  const [only = 32] = kinds;
  return kinds.size === 1 ? only : 32;
}

/**
 * Whether shaders find the scale of an entry by a shift: one scale for all, for each plane, or for a power of two
 * of whole entries. Our own files are of these; tables with other blocks become floats.
 */
function hasEasyScales({ shape, stored }: Tensor, isPlanes: boolean): boolean {
  if (stored.kind !== "codes" || stored.block >= product(shape)) return true;
  const [nFeatures, inPlane] = [shape.at(-1) ?? 1, product(shape.slice(1))];
  if (isPlanes && inPlane % stored.block) return false;
  return (isPlanes && stored.block === inPlane) || isPowerOfTwo(stored.block / nFeatures);
}

function planEntry(
  bits: TableBits,
  nFeatures: number,
  isPlanes: boolean,
): { entry: EntryLayout; format: TextureFormat } {
  const entryBits = bits * 2 ** Math.ceil(Math.log2(nFeatures));
  const texelBits = Math.min(Math.max(entryBits, 32), 128);
  const entriesPerTexel = isPlanes ? 1 : Math.max(32 / entryBits, 1);
  const texelsPerEntry = Math.max(entryBits / 128, 1);
  const format = ({ 32: "r32uint", 64: "rg32uint", 128: "rgba32uint" } as const)[texelBits];
  if (!format) throw new Error(`no texel of ${texelBits} bits`);
  return { entry: { bits, nFeatures, entryBits, entriesPerTexel, texelsPerEntry }, format };
}

/** Scales that go among the constants. */
function scaleCount(field: Field, { tensor, firstScale }: TablePlacement): number {
  const { stored } = tensorOf(field, tensor);
  return firstScale >= 0 && stored.kind === "codes" ? stored.scales.length : 0;
}
