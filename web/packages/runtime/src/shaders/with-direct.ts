/** Indirect light and a baked map of what the lights themselves give. */
import { expect } from "../errors.js";
import type { LightTexture } from "../formats/ktx2.js";
import type { TextureLimits } from "../gpu/texture.js";
import { composeText } from "./compose.js";
import type { LightInput, LightShader, ShaderLanguage } from "./light-shader.js";
import { bytesOf, mapTexture } from "./map-texture.js";

/** By input its name and its type, as WGSL and GLSL write it; in the order of parameters. */
const PARAMETERS: Readonly<Record<LightInput, readonly [name: string, wgsl: string, glsl: string]>> = {
  position: ["position", "vec3f", "vec3"],
  normal: ["normal", "vec3f", "vec3"],
  surfaceNormal: ["surface_normal", "vec3f", "vec3"],
  tangent: ["tangent", "vec4f", "vec4"],
  lightmapUv: ["lightmap_uv", "vec2f", "vec2"],
  page: ["page", "f32", "float"],
};
const ORDER = Object.keys(PARAMETERS) as LightInput[];
const MAP_INPUTS: readonly LightInput[] = ["lightmapUv", "page"];

/**
 * Adds first bounces, baked into a map of their own, to a source that leaves them out; views show that source.
 *
 * @param direct texels times `scale` are E/π; same uv and pages as the lightmap
 * @throws InputError where the source holds them already, or the map is too large for the device
 */
export function withDirect(
  shader: LightShader,
  direct: LightTexture,
  scale: number,
  limits: TextureLimits,
): LightShader {
  expect(
    shader.quantity === "indirect",
    "expected a source of indirect light, found one of all light",
    "direct map",
  );
  const inputs = ORDER.filter((input) => shader.inputs.includes(input) || MAP_INPUTS.includes(input));
  const texture = mapTexture("irradia_direct", direct, limits);
  const scales = { name: "irradia_direct_scale", values: Float32Array.of(Math.PI * scale, 0, 0, 0) };
  const { flops, fetches, bytes } = shader.cost;
  return {
    ...shader,
    inputs,
    textures: [...shader.textures, texture],
    uniforms: [...shader.uniforms, scales],
    quantity: "full",
    cost: { flops: flops + 9, fetches: fetches + 1, bytes: bytes + bytesOf([texture], 1) },
    text: (language) => summed(shader, inputs, language),
  };
}

/** The source's text with its functions renamed, the map's, and functions under the source's names around both. */
function summed(shader: LightShader, inputs: readonly LightInput[], language: ShaderLanguage): string {
  const views = Object.values(shader.views);
  const names = [shader.entry, ...views];
  const source = names.reduce(
    (text, name) => text.replaceAll(new RegExp(`\\b${name}\\b`, "g"), inner(name)),
    shader.text(language),
  );
  const call = (name: string): string => `${inner(name)}(${parameterNames(shader.inputs)})`;
  const direct = `irradia_direct_light(${parameterNames(MAP_INPUTS)})`;
  return [
    source,
    composeText(language, ["direct-light"]),
    wrapper(shader.entry, inputs, `${call(shader.entry)} + ${direct}`, language),
    ...views.map((name) => wrapper(name, inputs, call(name), language)),
  ].join("\n");
}

function inner(name: string): string {
  return `${name}_without_direct`;
}

function parameterNames(inputs: readonly LightInput[]): string {
  return inputs.map((input) => PARAMETERS[input][0]).join(", ");
}

/** A function of these inputs that gives an expression. */
function wrapper(
  name: string,
  inputs: readonly LightInput[],
  expression: string,
  language: ShaderLanguage,
): string {
  const parameters = inputs.map((input) => PARAMETERS[input]);
  if (language === "wgsl") {
    const list = parameters.map(([parameter, type]) => `${parameter}: ${type}`).join(", ");
    return `fn ${name}(${list}) -> vec3f { return ${expression}; }`;
  }
  const list = parameters.map(([parameter, , type]) => `${type} ${parameter}`).join(", ");
  return `vec3 ${name}(${list}) { return ${expression}; }`;
}
