/** A LightShader as a node: the very text of the runtime, in WGSL or GLSL as the backend wants it. */
import type { LightInput, LightShader, LightView, ShaderTexture, ShaderUniforms } from "@irradia/runtime";
import { buffer, sharedUniformGroup, texture } from "three/tsl";
import { CodeNode, Node, type NodeBuilder } from "three/webgpu";
import { textureOf } from "../core/textures.js";
import type { Inputs } from "../types.js";

/** Types by input, as nodes name them. */
const TYPES: Readonly<Record<LightInput, string>> = {
  position: "vec3",
  normal: "vec3",
  surfaceNormal: "vec3",
  tangent: "vec4",
  lightmapUv: "vec2",
  page: "float",
};

/** What this module asks of a NodeBuilder; its types say less. */
type Builder = NodeBuilder & {
  readonly renderer: {
    readonly backend: { readonly isWebGPUBackend?: boolean; readonly device?: GPUDevice };
  };
  /** Of builders for WGSL alone. */
  enableShaderF16?(): void;
  getCodeFromNode(node: Node, type: string): { code: string };
};
type Built = Node & { build(builder: NodeBuilder, output?: string): string };

const texts = /*@__PURE__*/ new WeakMap<LightShader, LightTextNode>();

/**
 * The light, or one of its views, as a vec3 node.
 *
 * @param inputs nodes for what the shader takes, at least
 */
export function lightNode(
  shader: LightShader,
  inputs: Partial<Inputs<Node>>,
  view?: LightView,
): Node<"vec3"> {
  const text = texts.get(shader) ?? new LightTextNode(shader);
  texts.set(shader, text);
  const wanted = shader.inputs.map((input) => inputs[input] ?? missing(input));
  const name = (view && shader.views[view]) ?? shader.entry;
  return new LightCallNode(text, name, shader.inputs, wanted) as unknown as Node<"vec3">;
}

function missing(input: LightInput): never {
  throw new Error(`the source takes ${input}, for which there is no node`);
}

/** A call of a function of the text. */
class LightCallNode extends Node {
  static get type(): string {
    return "IrradiaLightCallNode";
  }

  constructor(
    readonly text: LightTextNode,
    readonly functionName: string,
    readonly inputs: readonly LightInput[],
    /** Found by name by three.js, which builds them first. */
    readonly inputNodes: readonly Node[],
  ) {
    super("vec3");
  }

  override generate(builder: Builder): string {
    (this.text as Built).build(builder, "void");
    const args = this.inputNodes.map((node, i) =>
      (node as Built).build(builder, TYPES[this.inputs[i] ?? "page"]),
    );
    return `${this.functionName}( ${args.join(", ")} )`;
  }
}

/** The text, once in each shader, with three.js' names for the textures and uniforms in it. */
class LightTextNode extends CodeNode {
  readonly #shader: LightShader;
  readonly #textures: readonly Built[];
  readonly #uniforms: readonly Built[];

  static get type(): string {
    return "IrradiaLightTextNode";
  }

  constructor(shader: LightShader) {
    super();
    this.#shader = shader;
    const group = sharedUniformGroup("irradia"); // uploaded once, not at each frame
    this.#textures = shader.textures.map(
      (source) => texture(textureOf(source)).setName(source.name) as Built,
    );
    this.#uniforms = shader.uniforms.map((source) => constants(source).setGroup(group) as unknown as Built);
  }

  override generate(builder: Builder): string {
    const isWgsl = builder.renderer.backend.isWebGPUBackend === true;
    enableRequired(this.#shader, builder);
    const { textures, uniforms } = this.#shader;
    const names = [
      ...textures.map(({ name }, i) => [name, this.#textures[i]?.build(builder, "property")]),
      ...uniforms.map(({ name }, i) => [name, this.#uniforms[i]?.build(builder, "property")]),
    ] as [string, string][];
    const linear = textures.filter(({ access }) => access === "linear");
    const text = [
      ...linear.map((source) => sampler(source, isWgsl)),
      this.#shader.text(isWgsl ? "wgsl" : "glsl"),
    ].join("\n");
    const code = names.reduce((result, [from, to]) => renamed(result, from, to), text);
    builder.getCodeFromNode(this, "code").code = code;
    return code;
  }
}

/** Writes the directives that a text needs, which no module may have on a device without the feature. */
function enableRequired({ requires = [] }: LightShader, builder: Builder): void {
  for (const feature of requires) {
    if (!builder.renderer.backend.device?.features.has(feature))
      throw new Error(`the source needs a device with ${feature}; precisionOf(renderer) knows`);
    builder.enableShaderF16?.();
  }
}

function constants({ values }: ShaderUniforms) {
  return buffer(values, "vec4", values.length / 4);
}

function sampler({ name }: ShaderTexture, isWgsl: boolean): string {
  return isWgsl
    ? `fn ${name}_sample(uv: vec2f, layer: f32) -> vec4f { return textureSampleLevel(${name}, ${name}_sampler, uv, i32(layer), 0.0); }`
    : `vec4 ${name}_sample(vec2 uv, float layer) { return textureLod(${name}, vec3(uv, layer), 0.0); }`;
}

/** Another name for a binding, and for the sampler that belongs to it. */
function renamed(text: string, from: string, to: string): string {
  return from === to ? text : text.replaceAll(new RegExp(`\\b${from}(_sampler)?\\b`, "g"), `${to}$1`);
}
