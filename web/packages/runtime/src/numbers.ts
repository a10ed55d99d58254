/** Half floats, and what else numbers need. */
import { expect } from "./errors.js";

const EXPONENT = 0x7c00;
/** Larger ones are infinite. */
export const LARGEST_HALF = 65504;

/** The value of a half float's 16 bits (IEEE 754 binary16). */
export function halfToNumber(bits: number): number {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits & EXPONENT) >> 10;
  const mantissa = bits & 0x3ff;
  if (exponent === 31) return mantissa ? Number.NaN : sign * Number.POSITIVE_INFINITY;
  if (exponent === 0) return sign * mantissa * 2 ** -24;
  return sign * (1024 + mantissa) * 2 ** (exponent - 25);
}

/** The bits of the nearest half float; of two as near, the one whose last bit is 0. */
export function halfFromNumber(value: number): number {
  const magnitude = Math.abs(value);
  const sign = value < 0 ? 0x8000 : 0;
  if (magnitude >= LARGEST_HALF + 16) return sign | EXPONENT;
  const exponent = Math.max(Math.floor(Math.log2(magnitude)), -14);
  return sign | (((exponent + 14) << 10) + roundHalfEven(magnitude / 2 ** (exponent - 10)));
}

/** Half floats as floats, exactly. */
export function halvesToFloats(halves: Uint16Array): Float32Array {
  const floats = new Float32Array(halves.length);
  // Float32Array.from takes an iterator's way, which millions of weights would notice.
  for (let i = 0; i < halves.length; i++) floats[i] = halfToNumber(halves[i] ?? 0);
  return floats;
}

/** Refuses half floats that are infinite or not numbers. */
export function expectFiniteHalves(halves: Uint16Array, where: string): void {
  const finite = halves.every((bits) => (bits & EXPONENT) !== EXPONENT);
  expect(finite, "some numbers are infinite or not numbers", where);
}

/** Refuses floats that are infinite or not numbers. */
export function expectFinite(values: Float32Array, where: string): void {
  expect(values.every(Number.isFinite), "some numbers are infinite or not numbers", where);
}

/** The nearest whole number; halves go to the even one. */
export function roundHalfEven(value: number): number {
  const floor = Math.floor(value);
  const isTie = value - floor === 0.5;
  return isTie ? floor + (floor % 2 === 0 ? 0 : 1) : Math.round(value);
}

/** `value` between `low` and `high`. */
export function clamp(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

/** Whether a float holds `value`, and it is 2 to a whole power. */
export function isPowerOfTwo(value: number): boolean {
  return Math.fround(value) === value && value > 0 && 2 ** Math.round(Math.log2(value)) === value;
}

/** All factors multiplied; of none, 1. */
export function product(factors: readonly number[]): number {
  return factors.reduce((size, factor) => size * factor, 1);
}
