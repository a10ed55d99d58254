/** A LightShader in GLSL: declarations, samplers and functions, and what to bind to them. */
import type { LightInput, LightShader, LightView, ShaderTexture } from "@irradia/runtime";
import type { IUniform } from "three";
import { isInteger, textureOf } from "../core/textures.js";
import type { Inputs } from "../types.js";

export interface BoundShader {
  /** To be put in front of `main`. */
  readonly text: string;
  readonly uniforms: Readonly<Record<string, IUniform>>;
}

const bound = /*@__PURE__*/ new WeakMap<LightShader, BoundShader>();

/** The same for the same shader. */
export function bindGlsl(shader: LightShader): BoundShader {
  const found = bound.get(shader) ?? newBinding(shader);
  bound.set(shader, found);
  return found;
}

/** A call of the shader, or of one of its views, with expressions for what it takes. */
export function callOf(shader: LightShader, inputs: Partial<Inputs<string>>, view?: LightView): string {
  const args = shader.inputs.map((input: LightInput) => inputs[input] ?? missing(input));
  return `${(view && shader.views[view]) ?? shader.entry}(${args.join(", ")})`;
}

function missing(input: LightInput): never {
  throw new Error(`the source takes ${input}, for which there is no expression`);
}

function newBinding(shader: LightShader): BoundShader {
  const { textures, uniforms } = shader;
  const text = [
    ...textures.map(declaration),
    ...uniforms.map(({ name, values }) => `uniform vec4 ${name}[${values.length / 4}];`),
    ...textures.filter(({ access }) => access === "linear").map(sampler),
    shader.text("glsl"),
  ].join("\n");
  const ofTextures = textures.map((texture) => [texture.name, { value: textureOf(texture) }]);
  const ofUniforms = uniforms.map(({ name, values }) => [name, { value: values }]);
  return { text, uniforms: Object.fromEntries([...ofTextures, ...ofUniforms]) };
}

function declaration(texture: ShaderTexture): string {
  return `uniform highp ${isInteger(texture) ? "u" : ""}sampler2DArray ${texture.name};`;
}

function sampler({ name }: ShaderTexture): string {
  return `vec4 ${name}_sample(vec2 uv, float layer) { return textureLod(${name}, vec3(uv, layer), 0.0); }`;
}
