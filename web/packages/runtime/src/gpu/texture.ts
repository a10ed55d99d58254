/** GPU textures as plain data: what to create, and where in it things lie. */
import { expect } from "../errors.js";

/**
 * Formats by WebGPU's names. In WebGL2 they are R32UI, RG32UI, RGBA32UI and RGBA32F, RGB9_E5 and RGBA16F.
 * The first four are read with `textureLoad` or `texelFetch` alone; the last two also filter.
 */
export type TextureFormat =
  | "r32uint"
  | "rg32uint"
  | "rgba32uint"
  | "rgba32float"
  | "rgb9e5ufloat"
  | "rgba16float";

/** A two-dimensional array texture without mip levels, also where it has a single layer: one shader reads all. */
export interface TexturePlan {
  readonly format: TextureFormat;
  readonly width: number;
  readonly height: number;
  readonly layers: number;
  readonly nBytes: number;
}

/** What a device can take. */
export interface TextureLimits {
  /** Texels a side. */
  readonly maxSize: number;
  /** Of an array texture. */
  readonly maxLayers: number;
  /** Of one uniform block. */
  readonly maxUniformBytes: number;
}

/** What every WebGL2 device can take; ask `getParameter` for more. */
export const WEBGL2_LIMITS: TextureLimits = { maxSize: 2048, maxLayers: 256, maxUniformBytes: 16384 };
/** What every WebGPU device can take; ask `device.limits` for more. */
export const WEBGPU_LIMITS: TextureLimits = { maxSize: 8192, maxLayers: 256, maxUniformBytes: 65536 };

const TEXEL_BYTES: Readonly<Record<TextureFormat, number>> = {
  r32uint: 4,
  rg32uint: 8,
  rgba32uint: 16,
  rgba32float: 16,
  rgb9e5ufloat: 4,
  rgba16float: 8,
};

/** A texture of this size, or an InputError that names the limit. */
export function planTexture(
  format: TextureFormat,
  [width, height, layers]: readonly [number, number, number],
  limits: TextureLimits,
  what: string,
): TexturePlan {
  const fits = Math.max(width, height) <= limits.maxSize && layers <= limits.maxLayers;
  const most = `${limits.maxSize} × ${limits.maxSize} × ${limits.maxLayers}`;
  const finding = `expected at most ${most} texels, which is what this device takes, found ${width} × ${height} × ${layers}`;
  expect(fits, finding, what, "Train a smaller field, or bake smaller pages.");
  return { format, width, height, layers, nBytes: width * height * layers * TEXEL_BYTES[format] };
}

/**
 * A texture for a list of `count` texels: texel t lies at x = t mod width, y = ⌊t / width⌋ mod height, layer
 * ⌊t / (width · height)⌋. The width is a power of two, so that shaders may shift and mask; there are several
 * layers only where one isn't enough, and then height is a power of two as well.
 */
export function planList(
  format: TextureFormat,
  count: number,
  limits: TextureLimits,
  what: string,
): TexturePlan {
  const widest = 2 ** Math.floor(Math.log2(limits.maxSize));
  const width = Math.min(2 ** Math.ceil(Math.log2(Math.max(count, 1)) / 2), widest);
  const rows = Math.ceil(count / width);
  const height = Math.max(Math.min(rows, widest), 1);
  return planTexture(format, [width, height, Math.max(Math.ceil(rows / height), 1)], limits, what);
}
