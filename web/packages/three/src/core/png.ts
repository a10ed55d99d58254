/**
 * PNG images of 8-bit RGBA or grey, without a browser's canvas: that would multiply colours by alpha, which in a
 * shadow mask is a light like the others, and may convert them.
 */
import { expect } from "@irradia/runtime";

/** Known before an image is read. */
export interface ImageShape {
  readonly width: number;
  readonly height: number;
  /** RGBA, or grey. */
  readonly channels: 4 | 1;
}

const SIGNATURE = [0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a];
const HEADER = 0x49484452; // IHDR
const DATA = 0x49444154; // IDAT
const KINDS = { 4: ["RGBA", 6], 1: ["grey", 0] } as const; // as PNG numbers them

/**
 * Reads an image whose shape is known.
 *
 * @returns its texels, row by row from the top
 * @throws InputError where it is of another size or kind, cut short or damaged
 */
export async function readPng(bytes: Uint8Array, shape: ImageShape, where: string): Promise<Uint8Array> {
  const isPng = SIGNATURE.every((byte, i) => bytes[i] === byte);
  expect(isPng, "expected a PNG image", where);
  const parts: Uint8Array<ArrayBuffer>[] = [];
  for (const { kind, data } of chunksOf(bytes, where)) {
    if (kind === HEADER) expectHeader(data, shape, where);
    if (kind === DATA) parts.push(new Uint8Array(data));
  }
  const nBytes = shape.height * (1 + shape.channels * shape.width);
  return unfiltered(await inflated(parts, nBytes, where), shape, where);
}

function* chunksOf(bytes: Uint8Array, where: string): Generator<{ kind: number; data: Uint8Array }> {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  for (let at = SIGNATURE.length; at + 12 <= bytes.length; ) {
    const nBytes = view.getUint32(at);
    expect(at + 12 + nBytes <= bytes.length, "it is cut short", where);
    yield { kind: view.getUint32(at + 4), data: bytes.subarray(at + 8, at + 8 + nBytes) };
    at += 12 + nBytes;
  }
}

function expectHeader(data: Uint8Array, { width, height, channels }: ImageShape, where: string): void {
  expect(data.length === 13, "its header is damaged", where);
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const size = `${view.getUint32(0)} × ${view.getUint32(4)}`;
  expect(size === `${width} × ${height}`, `expected ${width} × ${height} pixels, found ${size}`, where);
  const [kind, code] = KINDS[channels];
  const plain = [8, code, 0, 0, 0]; // depth, kind of colour, compression, filter, interlacing
  const isPlain = plain.every((value, i) => data[8 + i] === value);
  expect(isPlain, `expected ${kind} of 8 bits, not interlaced`, where);
}

/** Exactly so many bytes; no more are ever held. */
async function inflated(
  parts: Uint8Array<ArrayBuffer>[],
  nBytes: number,
  where: string,
): Promise<Uint8Array> {
  const result = new Uint8Array(nBytes);
  let filled = 0;
  const stream = new Blob(parts).stream().pipeThrough(new DecompressionStream("deflate"));
  const reader = stream.getReader();
  for (;;) {
    const { done, value } = await reader.read().catch(() => ({ done: true, value: undefined }));
    if (done || !value) break;
    expect(filled + value.length <= nBytes, "it holds more than its size says", where);
    result.set(value, filled);
    filled += value.length;
  }
  expect(filled === nBytes, `expected ${nBytes} bytes unpacked, found ${filled}`, where);
  return result;
}

/** Undoes the filter of each row: PNG, third edition, section 9. */
function unfiltered(rows: Uint8Array, { width, height, channels }: ImageShape, where: string): Uint8Array {
  const stride = channels * width;
  const texels = new Uint8Array(stride * height);
  let above: Uint8Array = new Uint8Array(stride);
  for (let y = 0; y < height; y++) {
    const start = y * (stride + 1);
    const filter = rows[start] ?? 0;
    expect(filter <= 4, `expected a filter from 0 to 4, found ${filter}`, where);
    const row = texels.subarray(y * stride, (y + 1) * stride);
    row.set(rows.subarray(start + 1, start + 1 + stride));
    if (filter > 0) unfilter(row, above, filter, channels);
    above = row;
  }
  return texels;
}

/** In place. */
function unfilter(row: Uint8Array, above: Uint8Array, filter: number, channels: number): void {
  for (let x = 0; x < row.length; x++) {
    const isFirst = x < channels;
    const left = isFirst ? 0 : (row[x - channels] ?? 0);
    const upLeft = isFirst ? 0 : (above[x - channels] ?? 0);
    row[x] = (row[x] ?? 0) + predicted(filter, left, above[x] ?? 0, upLeft);
  }
}

function predicted(filter: number, left: number, up: number, upLeft: number): number {
  switch (filter) {
    case 1:
      return left;
    case 2:
      return up;
    case 3:
      return (left + up) >> 1;
    case 4: {
      const estimate = left + up - upLeft;
      const [a, b, c] = [Math.abs(estimate - left), Math.abs(estimate - up), Math.abs(estimate - upLeft)];
      if (a <= b && a <= c) return left;
      return b <= c ? up : upLeft;
    }
    default:
      return 0;
  }
}
