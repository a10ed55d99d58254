/** What shaders must know of an encoding, beside its class, which says what it computes. */
import type { Encoding } from "../../field/encoding.js";
import type { TableTexture } from "../field-textures.js";

/** An encoding as a part of one field. */
export interface EncodingPlace {
  /** The perceptron's column of its first feature. */
  readonly firstColumn: number;
  /** Of what it learns. */
  readonly table: TableTexture | undefined;
  /** Where scales of codes begin, in floats from the first constant. */
  readonly firstScale: number;
}

/** Work for one query; multiply-adds count as two operations. */
export interface EncodingCost {
  readonly flops: number;
  /** Of its table. */
  readonly fetches: number;
}

/** One encoding in shaders. */
export interface EncodingShader<E extends Encoding> {
  readonly type: string;
  /** File of `shaders/wgsl/`. */
  readonly piece: string;
  /** Its function: `fn NAME(record: u32, x: vec3f)`; with tables its name begins with `irradia_table`. */
  readonly function: string;
  /** Its numbers among the constants, as its piece's comment lists them; all vec4s. */
  record(encoding: E, place: EncodingPlace): Vec4[];
  cost(encoding: E, place: EncodingPlace): EncodingCost;
}

export type Vec4 = readonly [number, number, number, number];

/** Whole numbers below 2^32 as floats hold them: the lower 16 bits, then the upper. */
export function halves(whole: number): [number, number] {
  return [whole % 65536, Math.floor(whole / 65536)];
}

/** Features that a texel of a table holds. */
export function featuresPerTexel({ entry }: TableTexture): number {
  return Math.min(entry.entryBits, 128) / entry.bits;
}

/** Scales of one tensor: the first in floats from the first constant, and log2 of the entries that share one. */
export function scalesOf(table: TableTexture, tensor: number, firstScale: number): [number, number] {
  const placed = table.tensors[tensor];
  if (!placed || placed.firstScale < 0) return [0, 31];
  const entries = placed.block / table.entry.nFeatures;
  // One scale for everything has no power of two to shift by.
  const shift = Number.isInteger(Math.log2(entries)) ? Math.min(Math.log2(entries), 31) : 31;
  return [firstScale + placed.firstScale, shift];
}

/** The table that an encoding which learns was given. */
export function tableOf({ table }: EncodingPlace): TableTexture {
  if (!table) throw new Error("this encoding learns, so it has a table");
  return table;
}
