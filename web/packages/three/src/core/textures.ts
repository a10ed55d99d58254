/** Textures of sources as three.js has them. */
import type { LightShader, ShaderTexture, TextureFormat } from "@irradia/runtime";
import {
  DataArrayTexture,
  FloatType,
  HalfFloatType,
  LinearFilter,
  NearestFilter,
  type PixelFormat,
  RedIntegerFormat,
  RGBAFormat,
  RGBAIntegerFormat,
  RGBFormat,
  RGIntegerFormat,
  type TextureDataType,
  UnsignedInt5999Type,
  UnsignedIntType,
} from "three";

interface Format {
  readonly format: PixelFormat;
  readonly type: TextureDataType;
}

/** Without names of internal formats, which each backend would take for its own; all find the right ones. */
const FORMATS: Readonly<Record<TextureFormat, Format>> = {
  r32uint: { format: RedIntegerFormat, type: UnsignedIntType },
  rg32uint: { format: RGIntegerFormat, type: UnsignedIntType },
  rgba32uint: { format: RGBAIntegerFormat, type: UnsignedIntType },
  rgba32float: { format: RGBAFormat, type: FloatType },
  rgb9e5ufloat: { format: RGBFormat, type: UnsignedInt5999Type },
  rgba16float: { format: RGBAFormat, type: HalfFloatType },
};

/** One texture for each that a shader names, wherever that is bound. */
const known = /*@__PURE__*/ new WeakMap<ShaderTexture, DataArrayTexture>();

/** The texture that three.js uploads, once, when it is first drawn with. */
export function textureOf(source: ShaderTexture): DataArrayTexture {
  const texture = known.get(source) ?? newTexture(source);
  known.set(source, texture);
  return texture;
}

/** Whether texels are whole numbers, which shaders declare differently. */
export function isInteger({ plan }: ShaderTexture): boolean {
  return plan.format.endsWith("uint");
}

/** Frees what a shader holds on GPUs, but for what is `kept`; drawing with it again uploads it again. */
export function disposeTextures(shader: LightShader, kept: ReadonlySet<ShaderTexture> = new Set()): void {
  for (const texture of shader.textures) if (!kept.has(texture)) known.get(texture)?.dispose();
}

function newTexture({ name, plan, data, access }: ShaderTexture): DataArrayTexture {
  const { width, height, layers } = plan;
  const { format, type } = FORMATS[plan.format];
  const texture = new DataArrayTexture(data as Uint32Array<ArrayBuffer>, width, height, layers);
  texture.name = name;
  texture.format = format;
  texture.type = type;
  texture.minFilter = texture.magFilter = access === "linear" ? LinearFilter : NearestFilter;
  texture.needsUpdate = true;
  return texture;
}
