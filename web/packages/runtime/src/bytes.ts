/**
 * Little-endian reading that never leaves its bytes.
 *
 * Typed arrays have the byte order of the machine; every machine with WebGL or WebGPU is little-endian.
 */
import { expect } from "./errors.js";

const CUT_SHORT = "The file is damaged or was cut short.";

/** Reads numbers and pieces of some bytes; whatever lies outside them is an InputError. */
export class ByteReader {
  readonly bytes: Uint8Array;
  readonly where: string;
  readonly #view: DataView;

  constructor(bytes: Uint8Array, where: string) {
    this.bytes = bytes;
    this.where = where;
    this.#view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  get length(): number {
    return this.bytes.byteLength;
  }

  u32(at: number): number {
    this.#check(at, 4);
    return this.#view.getUint32(at, true);
  }

  f32(at: number): number {
    this.#check(at, 4);
    return this.#view.getFloat32(at, true);
  }

  /** An unsigned integer of 64 bits; such as a double can't hold exactly are damage. */
  u64(at: number): number {
    this.#check(at, 8);
    const value = this.#view.getBigUint64(at, true);
    expect(value <= BigInt(Number.MAX_SAFE_INTEGER), `found an absurd size or offset, ${value}`, this.where);
    return Number(value);
  }

  /** A view, not a copy, of `length` bytes. */
  slice(at: number, length: number): Uint8Array {
    this.#check(at, length);
    return this.bytes.subarray(at, at + length);
  }

  #check(at: number, length: number): void {
    const fits = Number.isInteger(at) && Number.isInteger(length) && at >= 0 && length >= 0;
    expect(
      fits && at + length <= this.length,
      `expected ${length} bytes at ${at}, found a file of ${this.length}`,
      this.where,
      CUT_SHORT,
    );
  }
}

/** Bytes as 16-bit numbers; copied where they don't lie on even addresses. */
export function asUint16(bytes: Uint8Array): Uint16Array {
  const even = aligned(bytes, 2);
  return new Uint16Array(even.buffer, even.byteOffset, Math.floor(even.byteLength / 2));
}

/** Bytes as 32-bit numbers; likewise. */
export function asUint32(bytes: Uint8Array): Uint32Array {
  const even = aligned(bytes, 4);
  return new Uint32Array(even.buffer, even.byteOffset, Math.floor(even.byteLength / 4));
}

/** Bytes as floats; likewise. */
export function asFloat32(bytes: Uint8Array): Float32Array {
  const even = aligned(bytes, 4);
  return new Float32Array(even.buffer, even.byteOffset, Math.floor(even.byteLength / 4));
}

function aligned(bytes: Uint8Array, size: number): Uint8Array {
  return bytes.byteOffset % size === 0 ? bytes : bytes.slice();
}
