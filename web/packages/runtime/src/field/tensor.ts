/** Weights as files hold them: half floats, floats, or codes times scales. */
import { expect } from "../errors.js";
import { halfToNumber, halvesToFloats, product } from "../numbers.js";

/** Half floats by their bits. */
export interface Halves {
  readonly kind: "half";
  readonly bits: Uint16Array;
}

export interface Floats {
  readonly kind: "float";
  readonly values: Float32Array;
}

/** value = code · scale, with one scale for each block of consecutive values. */
export interface Codes {
  readonly kind: "codes";
  readonly bits: 4 | 8;
  /** Values of a block; the last may have fewer. */
  readonly block: number;
  /** Signed bytes, or two codes to a byte with 8 added to each, the first in the lower bits. */
  readonly codes: Uint8Array;
  /** Half floats by their bits. */
  readonly scales: Uint16Array;
}

/** An array of weights; axes are row-major. */
export interface Tensor {
  readonly shape: readonly number[];
  readonly stored: Halves | Floats | Codes;
}

/** Bits that a value takes as stored. */
export function bitsPerValue(tensor: Tensor): 4 | 8 | 16 | 32 {
  const { stored } = tensor;
  if (stored.kind === "codes") return stored.bits;
  return stored.kind === "half" ? 16 : 32;
}

/** The weights' bytes as stored: half floats, floats, or codes without their scales. */
export function storedBytes({ stored }: Tensor): Uint8Array {
  if (stored.kind === "codes") return stored.codes;
  const numbers = stored.kind === "half" ? stored.bits : stored.values;
  return new Uint8Array(numbers.buffer, numbers.byteOffset, numbers.byteLength);
}

/** All values as floats. */
export function tensorValues(tensor: Tensor): Float32Array {
  const { stored } = tensor;
  if (stored.kind === "half") return halvesToFloats(stored.bits);
  if (stored.kind === "float") return stored.values;
  const scales = halvesToFloats(stored.scales);
  const values = new Float32Array(product(tensor.shape));
  for (let i = 0; i < values.length; i++) {
    values[i] = codeAt(stored, i) * (scales[Math.floor(i / stored.block)] ?? 0);
  }
  return values;
}

/** The signed code of a value. */
export function codeAt(stored: Codes, index: number): number {
  if (stored.bits === 8) return ((stored.codes[index] ?? 0) << 24) >> 24;
  const pair = stored.codes[index >> 1] ?? 0;
  return ((index & 1 ? pair >> 4 : pair) & 15) - 8;
}

/** The scale of a block of codes. */
export function scaleAt(stored: Codes, block: number): number {
  return halfToNumber(stored.scales[block] ?? 0);
}

/** Refuses a tensor that isn't of the shape, or whose codes and scales don't fit it. */
export function expectTensor(tensor: Tensor, shape: readonly number[], where: string): void {
  const same = tensor.shape.length === shape.length && tensor.shape.every((n, axis) => n === shape[axis]);
  expect(same, `expected shape (${shape}), found (${tensor.shape})`, where);
  const { stored } = tensor;
  const size = product(shape);
  if (stored.kind !== "codes") {
    const found = stored.kind === "half" ? stored.bits.length : stored.values.length;
    expect(found === size, `expected ${size} values, found ${found}`, where);
    return;
  }
  const nBytes = Math.ceil((size * stored.bits) / 8);
  const nBlocks = Math.ceil(size / stored.block);
  const fits = stored.codes.length === nBytes && stored.scales.length === nBlocks;
  const found = `${stored.codes.length} and ${stored.scales.length}`;
  expect(fits, `expected ${nBytes} bytes of codes and ${nBlocks} scales, found ${found}`, where);
}
