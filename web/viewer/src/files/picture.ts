/** Pictures from files: panoramas that light, and renders to compare with. */
import { InputError } from "@irradia/runtime";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import {
  DataTexture,
  DataUtils,
  EquirectangularReflectionMapping,
  FloatType,
  HalfFloatType,
  LinearFilter,
  LinearSRGBColorSpace,
  NoColorSpace,
  RGBAFormat,
  type Texture,
} from "three/webgpu";
import { type NamedFile, wholeBuffer } from "./kinds.js";
import { readRadianceHdr } from "./radiance.js";
import { linearFromSrgb, unshoulder } from "./shoulder.js";

export interface Picture {
  readonly name: string;
  readonly width: number;
  readonly height: number;
  /** Top row first. */
  readonly texture: Texture;
  /** Whether its numbers are light; else they are what a display shows. */
  readonly isLinear: boolean;
}

const LARGEST_HALF = 65504;
const EXR_MAGIC = 0x76;

/** Reads .hdr or .exr: linear light. */
export function readRadiance(file: NamedFile): Picture {
  const { name, bytes } = file;
  if (bytes[0] === EXR_MAGIC) return readExr(file);
  const { width, height, linear } = readRadianceHdr(bytes, name);
  return { name, width, height, texture: floatTexture(linear, width, height), isLinear: true };
}

/**
 * Reads .png or .jpg.
 *
 * @param ev the exposure at which one of our own pictures was written; then light is made of it again
 */
export async function readPicture(file: NamedFile, ev?: number): Promise<Picture> {
  const blob = new Blob([file.bytes as Uint8Array<ArrayBuffer>]);
  let bitmap: ImageBitmap;
  try {
    bitmap = await createImageBitmap(blob, { premultiplyAlpha: "none", colorSpaceConversion: "none" });
  } catch {
    throw new InputError("expected a PNG or JPEG picture, found damaged bytes", file.name, "Write it again.");
  }
  const { width, height } = bitmap;
  const rgba = pixelsOf(bitmap);
  const decode =
    ev === undefined ? linearFromSrgb : (value: number) => unshoulder(linearFromSrgb(value)) / 2 ** ev;
  const table = Float32Array.from({ length: 256 }, (_, code) => decode(code / 255));
  const linear = new Float32Array(rgba.length);
  for (let i = 0; i < rgba.length; i += 1) {
    const code = rgba[i] ?? 0;
    linear[i] = i % 4 === 3 ? code / 255 : (table[code] ?? 0);
  }
  return {
    name: file.name,
    width,
    height,
    texture: floatTexture(linear, width, height),
    isLinear: ev !== undefined,
  };
}

function pixelsOf(bitmap: ImageBitmap): Uint8ClampedArray {
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d");
  if (!context) throw new InputError("expected a 2D canvas, found none", "browser");
  context.drawImage(bitmap, 0, 0);
  return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
}

/** EXRLoader's rows begin at the bottom. */
function readExr({ name, bytes }: NamedFile): Picture {
  const { width, height, data } = parseExr(name, bytes);
  const linear = new Float32Array(4 * width * height);
  for (let y = 0; y < height; y += 1) {
    linear.set(data.subarray(4 * width * (height - 1 - y), 4 * width * (height - y)), 4 * width * y);
  }
  for (let i = 3; i < linear.length; i += 4) linear[i] = 1;
  return { name, width, height, texture: floatTexture(linear, width, height), isLinear: true };
}

function parseExr(name: string, bytes: Uint8Array): { width: number; height: number; data: Float32Array } {
  const loader = new EXRLoader();
  loader.type = FloatType;
  try {
    const parsed = loader.parse(wholeBuffer(bytes)) as {
      width: number;
      height: number;
      data: Float32Array;
    };
    if (parsed.data.length === 4 * parsed.width * parsed.height && parsed.data.length > 0) return parsed;
    throw new Error("no colours");
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    throw new InputError(`expected an OpenEXR picture in colour, found: ${message}`, name, "Write it again.");
  }
}

function floatTexture(linear: Float32Array, width: number, height: number): Texture {
  const texture = new DataTexture(linear, width, height, RGBAFormat, FloatType);
  texture.colorSpace = NoColorSpace;
  texture.needsUpdate = true;
  return texture;
}

/** A panorama as three.js wants environments: half floats, which every GPU filters. */
export function environmentOf({ texture, width, height }: Picture): Texture {
  const linear = (texture.image as { data: Float32Array }).data;
  const halves = new Uint16Array(linear.length);
  for (let i = 0; i < linear.length; i += 1) {
    halves[i] = DataUtils.toHalfFloat(Math.min(linear[i] ?? 0, LARGEST_HALF));
  }
  const environment = new DataTexture(halves, width, height, RGBAFormat, HalfFloatType);
  environment.mapping = EquirectangularReflectionMapping;
  environment.colorSpace = LinearSRGBColorSpace;
  environment.minFilter = environment.magFilter = LinearFilter;
  environment.flipY = true;
  environment.needsUpdate = true;
  return environment;
}
