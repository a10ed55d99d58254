/**
 * KTX 2.0 textures as Irradia writes them: RGB9E5 or half RGBA, array layers for pages, packed or not.
 *
 * Only the largest mip level is read; lightmaps have no other.
 */
import { asUint16, asUint32, ByteReader } from "../bytes.js";
import { expect } from "../errors.js";
import { expectFiniteHalves, halfToNumber } from "../numbers.js";
import { DEFAULT_MAX_BYTES, type UnpackOptions, unpack } from "./zstd.js";

/** Of a texel: VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, or VK_FORMAT_R16G16B16A16_SFLOAT. */
export type TexelEncoding = "rgb9e5" | "half";

/** Pages of light. Row 0 is the top, layers follow each other. */
export interface LightTexture {
  readonly width: number;
  readonly height: number;
  readonly layers: number;
  readonly encoding: TexelEncoding;
  /** A word a texel of `rgb9e5`, four half floats a texel of `half`: what a GPU texture takes as it is. */
  readonly texels: Uint32Array | Uint16Array;
}

const IDENTIFIER = [0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb, 0x0d, 0x0a, 0x1a, 0x0a];
const LEVEL_INDEX = 80;
const FORMATS = new Map<number, TexelEncoding>([
  [123, "rgb9e5"],
  [97, "half"],
]);
const TEXEL_BYTES: Readonly<Record<TexelEncoding, number>> = { rgb9e5: 4, half: 8 };
const MAX_SIDE = 32768;
const MAX_LAYERS = 2048;
const ZSTD = 2;

/**
 * Reads a texture's largest level.
 *
 * @throws InputError where it is of another format or shape, cut short or damaged
 */
export function readKtx2(bytes: Uint8Array, where: string, options: UnpackOptions = {}): LightTexture {
  const file = new ByteReader(bytes, where);
  const isKtx2 = IDENTIFIER.every((byte, i) => bytes[i] === byte);
  expect(isKtx2, "expected a KTX 2.0 texture", where);
  const shape = readShape(file);
  const nBytes = shape.width * shape.height * shape.layers * TEXEL_BYTES[shape.encoding];
  const { maxBytes = DEFAULT_MAX_BYTES } = options;
  expect(nBytes <= maxBytes, `expected at most ${maxBytes} bytes of texels, found ${nBytes}`, where);
  const raw = readLevel(file, nBytes, options);
  if (shape.encoding === "rgb9e5") return { ...shape, texels: asUint32(raw) };
  const halves = asUint16(raw);
  expectFiniteHalves(halves, where);
  return { ...shape, texels: halves };
}

/** Linear Rec.709 of a texel; not yet multiplied by the map's scale. */
export function texelRgb(texture: LightTexture, x: number, y: number, layer = 0): [number, number, number] {
  const index = (layer * texture.height + y) * texture.width + x;
  if (texture.encoding === "half") {
    const channel = (c: number): number => halfToNumber(texture.texels[4 * index + c] ?? 0);
    return [channel(0), channel(1), channel(2)];
  }
  const word = texture.texels[index] ?? 0;
  const step = 2 ** ((word >>> 27) - 24); // bias 15, and 9 bits of mantissa
  return [(word & 511) * step, ((word >>> 9) & 511) * step, ((word >>> 18) & 511) * step];
}

function readShape(file: ByteReader): Omit<LightTexture, "texels"> {
  const [format, , width, height, depth, layers, faces, levels] = Array.from({ length: 8 }, (_, i) =>
    file.u32(12 + 4 * i),
  ) as [number, number, number, number, number, number, number, number];
  const encoding = FORMATS.get(format);
  expect(
    encoding !== undefined,
    `expected RGB9E5 or half RGBA, found the Vulkan format ${format}`,
    file.where,
  );
  const isPlain = depth === 0 && faces === 1 && levels >= 1 && levels <= 16 && layers <= MAX_LAYERS;
  const found = `depth ${depth}, ${layers} layers, ${faces} faces, ${levels} levels`;
  expect(isPlain, `expected a 2D texture or array, found ${found}`, file.where);
  const isSized = width >= 1 && width <= MAX_SIDE && height >= 1 && height <= MAX_SIDE;
  expect(isSized, `expected at most ${MAX_SIDE} texels a side, found ${width} × ${height}`, file.where);
  return { width, height, layers: Math.max(layers, 1), encoding };
}

function readLevel(file: ByteReader, nBytes: number, options: UnpackOptions): Uint8Array {
  const scheme = file.u32(44);
  expect(scheme === 0 || scheme === ZSTD, `expected no packing or Zstandard, found ${scheme}`, file.where);
  const stored = file.slice(file.u64(LEVEL_INDEX), file.u64(LEVEL_INDEX + 8));
  const inflated = file.u64(LEVEL_INDEX + 16);
  expect(inflated === nBytes, `expected ${nBytes} bytes of texels, found ${inflated}`, file.where);
  if (scheme === ZSTD) return unpack(stored, nBytes, file.where, options);
  expect(stored.length === nBytes, `expected ${nBytes} bytes of texels, found ${stored.length}`, file.where);
  return stored;
}
