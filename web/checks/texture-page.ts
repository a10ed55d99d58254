/** Reads every texel of a KTX2 texture through the GPU's own decoder, as floats. */
import { read, VK_FORMAT_BC6H_UFLOAT_BLOCK } from "ktx-parse";
import {
  CompressedTexture,
  FloatType,
  GLSL3,
  HalfFloatType,
  Mesh,
  NearestFilter,
  OrthographicCamera,
  PlaneGeometry,
  RGB_BPTC_UNSIGNED_Format,
  ShaderMaterial,
  type Texture,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { KTX2Loader } from "three/addons/loaders/KTX2Loader.js";
import { ZSTDDecoder } from "zstddec";

/** Linear RGBA, the texture's first row first, and who parsed the file. */
export interface Sampled {
  width: number;
  height: number;
  parser: "KTX2Loader" | "ktx-parse";
  pixels: number[];
}

declare global {
  interface Window {
    sample: (address: string) => Promise<Sampled>;
  }
}

const FRAGMENT = `
  uniform sampler2D map;
  layout(location = 0) out highp vec4 texel;
  void main() { texel = texelFetch(map, ivec2(gl_FragCoord.xy), 0); }`;
const VERTEX = "void main() { gl_Position = vec4(position.xy * 2.0, 0.0, 1.0); }";

const renderer = new WebGLRenderer();
const loader = new KTX2Loader().detectSupport(renderer);

window.sample = async (address) => {
  const data = await (await fetch(address)).arrayBuffer();
  const container = read(new Uint8Array(data));
  // three.js 0.187 loads all that we write but BC6H, which its loader takes for Basis alone.
  const isBc6h = container.vkFormat === VK_FORMAT_BC6H_UFLOAT_BLOCK;
  const texture = isBc6h ? await bc6h(container) : await loaded(data);
  const { pixelWidth: width, pixelHeight: height } = container;
  const pixels = texels(texture, width, height);
  return { width, height, parser: isBc6h ? "ktx-parse" : "KTX2Loader", pixels };
};

function loaded(data: ArrayBuffer): Promise<Texture> {
  return new Promise((resolve, reject) => loader.parse(data, resolve, reject));
}

async function bc6h(container: ReturnType<typeof read>): Promise<Texture> {
  if (!renderer.extensions.has("EXT_texture_compression_bptc")) throw new Error("WebGL has no BPTC here");
  const decoder = new ZSTDDecoder();
  await decoder.init();
  const mipmaps = container.levels.map((level, index) => ({
    data: container.supercompressionScheme
      ? decoder.decode(level.levelData, level.uncompressedByteLength)
      : level.levelData,
    width: Math.max(container.pixelWidth >> index, 1),
    height: Math.max(container.pixelHeight >> index, 1),
  }));
  const { pixelWidth, pixelHeight } = container;
  const format = RGB_BPTC_UNSIGNED_Format;
  const texture = new CompressedTexture(mipmaps, pixelWidth, pixelHeight, format, HalfFloatType);
  texture.needsUpdate = true;
  return texture;
}

function texels(texture: Texture, width: number, height: number): number[] {
  texture.minFilter = NearestFilter;
  texture.magFilter = NearestFilter;
  const target = new WebGLRenderTarget(width, height, { type: FloatType });
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { map: { value: texture } },
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    depthTest: false,
  });
  const plane = new Mesh(new PlaneGeometry(1, 1), material);
  plane.frustumCulled = false;
  renderer.setRenderTarget(target);
  renderer.render(plane, new OrthographicCamera());
  const rgba = new Float32Array(width * height * 4);
  renderer.readRenderTargetPixels(target, 0, 0, width, height, rgba);
  if (renderer.getContext().getError() !== 0) throw new Error("WebGL reported an error");
  return Array.from(rgba);
}
