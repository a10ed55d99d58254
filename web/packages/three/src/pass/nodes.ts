/** Texts of the pass as nodes of WebGPURenderer, in WGSL or GLSL as the backend wants it. */
import { prepassText, type ScreenStage, type ShaderLanguage, screenCall } from "@irradia/runtime";
import { cameraViewMatrix, negateOnBackSide, normalViewGeometry, normalWorld, positionView } from "three/tsl";
import { CodeNode, Node, type NodeBuilder, type WebGPURenderer } from "three/webgpu";

/** What this module asks of a NodeBuilder; its types say less. */
type Builder = NodeBuilder & {
  readonly renderer: WebGPURenderer;
  getCodeFromNode(node: Node, type: string): { code: string };
  getFragCoord(): string;
};
type Built = { build(builder: NodeBuilder, output?: string): string };

/** Functions, once in each shader, with three.js' names for what is bound to them. */
export class TextNode extends CodeNode {
  readonly #text: (language: ShaderLanguage) => string;
  readonly #bindings: Readonly<Record<string, Node>>;
  readonly #before: Node | undefined;

  static get type(): string {
    return "IrradiaTextNode";
  }

  /** @param before a node whose functions come first; what it gives is thrown away */
  constructor(
    text: (language: ShaderLanguage) => string,
    bindings: Readonly<Record<string, Node>>,
    before?: Node,
  ) {
    super();
    this.#text = text;
    this.#bindings = bindings;
    this.#before = before;
  }

  override generate(builder: Builder): string {
    if (this.#before) built(this.#before).build(builder);
    const code = Object.entries(this.#bindings).reduce(
      (text, [name, node]) => {
        return text.replaceAll(new RegExp(`\\b${name}\\b`, "g"), `${built(node).build(builder, "property")}`);
      },
      this.#text(languageOf(builder.renderer)),
    );
    builder.getCodeFromNode(this, "code").code = code;
    return code;
  }
}

/** E at the pixel that is drawn. */
export class PixelLightNode extends Node {
  static get type(): string {
    return "IrradiaPixelLightNode";
  }

  constructor(
    readonly text: TextNode,
    readonly stage: ScreenStage,
  ) {
    super("vec3");
  }

  override generate(builder: Builder): string {
    built(this.text).build(builder, "void");
    const vector = languageOf(builder.renderer) === "wgsl" ? "vec2u" : "uvec2";
    return screenCall(this.stage, `${vector}( ${builder.getFragCoord()} )`);
  }
}

/** What a prepass stores of the surface that is drawn. */
class SurfaceNode extends Node {
  static get type(): string {
    return "IrradiaSurfaceNode";
  }

  constructor(
    readonly text: TextNode,
    readonly normal: Node,
    readonly surfaceNormal: Node,
    readonly depth: Node,
  ) {
    super("vec4");
  }

  override generate(builder: Builder): string {
    built(this.text).build(builder, "void");
    const vectors = [this.normal, this.surfaceNormal].map((node) => built(node).build(builder, "vec3"));
    return `irradia_screen_packed( ${vectors.join(", ")}, ${built(this.depth).build(builder, "float")} )`;
  }
}

/** A node of a material's own, as its output. */
export function surfaceNode(): Node<"vec4"> {
  const facing = negateOnBackSide(normalViewGeometry).transformNormalByInverseViewMatrix(cameraViewMatrix);
  const depth = positionView.z.negate();
  return new SurfaceNode(
    new TextNode(prepassText, {}),
    normalWorld,
    facing,
    depth,
  ) as unknown as Node<"vec4">;
}

/** Which text a backend takes. */
export function languageOf({ backend }: WebGPURenderer): ShaderLanguage {
  return "isWebGPUBackend" in backend ? "wgsl" : "glsl";
}

function built(node: Node): Built {
  return node as unknown as Built;
}
