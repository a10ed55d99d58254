/**
 * A source of light as a shader sees it: text with one entry function, and what to bind to it.
 *
 * Everything that lights a scene (a lightmap, a field, probes) becomes one of these, so an engine needs one
 * piece of glue: bind the textures and uniforms under their names, put the text in front of the shader,
 * call the entry.
 */
import type { TexturePlan } from "../gpu/texture.js";

/** What a device must have beside the usual, by WebGPU's names. `shader-f16` goes with `enable f16;`. */
export type ShaderFeature = "shader-f16";

/** `glsl` is GLSL ES 3.00, made from the WGSL by naga. */
export type ShaderLanguage = "wgsl" | "glsl";

/**
 * What an entry function takes, in this order of its parameters; those that a source doesn't list are left out.
 *
 * | input | type | |
 * |---|---|---|
 * | `position` | vec3 | world space, metres |
 * | `normal` | vec3 | the shading normal, unit, world space, facing the viewer |
 * | `surfaceNormal` | vec3 | the interpolated vertex normal, likewise, before normal maps |
 * | `tangent` | vec4 | world space, w the bitangent's sign, as in glTF |
 * | `lightmapUv` | vec2 | of the page, origin top left |
 * | `page` | f32 | layer of the lightmap; a whole number |
 */
export type LightInput = "position" | "normal" | "surfaceNormal" | "tangent" | "lightmapUv" | "page";

/** A texture that the text reads by its name; always a 2D array. */
export interface ShaderTexture {
  readonly name: string;
  readonly plan: TexturePlan;
  /** Layer by layer, row by row from the top. */
  readonly data: Uint8Array | Uint16Array | Uint32Array | Float32Array;
  /**
   * `load`: the text reads it with textureLoad or texelFetch. `linear`: it calls a function
   * `NAME_sample(uv: vec2f, layer: f32) -> vec4f` that the glue declares, since samplers differ by target:
   * linear filtering, clamped to the edge, mip level 0.
   */
  readonly access: "load" | "linear";
}

/** An array of vec4s that the text reads by its name. */
export interface ShaderUniforms {
  readonly name: string;
  readonly values: Float32Array;
}

/** Work for one call of the entry; multiply-adds count as two. */
export interface ShaderCost {
  readonly flops: number;
  readonly fetches: number;
  /** Of textures and uniforms on the GPU. */
  readonly bytes: number;
}

/** Debug views that a source may offer beside its light, as further functions with the same parameters. */
export type LightView = "raw" | "hidden" | "unclamped" | "unit-position" | "validity";

export interface LightShader {
  /**
   * `fn irradia_light(…inputs) -> vec3f`: irradiance E in W·m⁻², linear Rec.709, never negative. All names in
   * the text begin with `irradia_`.
   */
  readonly entry: "irradia_light";
  readonly inputs: readonly LightInput[];
  readonly textures: readonly ShaderTexture[];
  readonly uniforms: readonly ShaderUniforms[];
  /**
   * What its text needs of the device; absent where that is nothing. WGSL's directives come before all else in a
   * module, so glue writes them: see `directives`.
   */
  readonly requires?: readonly ShaderFeature[];
  /** Whether first bounces of live lights are left out of the light. */
  readonly quantity: "full" | "indirect";
  readonly cost: ShaderCost;
  /** By view the name of its function, which gives a colour in [0, 1] or raw numbers. */
  readonly views: Readonly<Partial<Record<LightView, string>>>;
  /** Functions alone: no declarations of textures and uniforms, no entry point, no version line. */
  text(language: ShaderLanguage): string;
}

/** What a module in WGSL begins with, for what a shader requires; empty for most. */
export function directives({ requires = [] }: LightShader): string {
  return requires.includes("shader-f16") ? "enable f16;\n" : "";
}
