/** Light evaluated once a pixel, for WebGPURenderer on either of its backends. */
import { type LightShader, type ScreenStage, screenCall, screenText } from "@irradia/runtime";
import {
  type Camera,
  Color,
  FloatType,
  type Material,
  NearestFilter,
  NoBlending,
  type Object3D,
  type Texture,
  type Vector2,
} from "three";
import { buffer, normalWorld, positionView, texture, vec3, vec4 } from "three/tsl";
import {
  CodeNode,
  Node,
  type NodeBuilder,
  NodeMaterial,
  QuadMesh,
  RenderTarget,
  type TextureNode,
  type WebGPURenderer,
} from "three/webgpu";
import type { SceneLight } from "../types.js";
import { lightNode } from "../webgpu/bind.js";
import {
  BaseIrradiancePass,
  type IrradiancePassOptions,
  type PassDrawer,
  plainCopy,
  type StageInputs,
} from "./irradiance-pass.js";

export type { IrradiancePassOptions } from "./irradiance-pass.js";

/** As `IrradiancePass` of `@irradia/three`, for WebGPURenderer. */
export class IrradiancePass extends BaseIrradiancePass<RenderTarget> {
  constructor(renderer: WebGPURenderer, light: SceneLight, options: IrradiancePassOptions = {}) {
    super(new WebGPUPassDrawer(renderer), light, options);
  }
}

interface Stage {
  readonly quad: QuadMesh;
  readonly surfaces: TextureNode;
  readonly half: TextureNode | undefined;
}

class WebGPUPassDrawer implements PassDrawer<RenderTarget> {
  readonly #renderer: WebGPURenderer;
  readonly #stages = new WeakMap<LightShader, Map<ScreenStage, Stage>>();

  constructor(renderer: WebGPURenderer) {
    this.#renderer = renderer;
  }

  get isBottomUp(): boolean {
    return !isWebGPU(this.#renderer);
  }

  sizeTo(size: Vector2): void {
    const target = this.#renderer.getRenderTarget();
    if (target) size.set(target.width, target.height);
    else this.#renderer.getDrawingBufferSize(size);
  }

  surfaceMaterial(original: Material): Material {
    const copy = plainCopy(original) as NodeMaterial;
    copy.fog = false;
    copy.lights = false;
    copy.outputNode = vec4(normalWorld, positionView.z.negate());
    return copy;
  }

  newTarget(hasDepth: boolean): RenderTarget {
    const filters = { minFilter: NearestFilter, magFilter: NearestFilter };
    return new RenderTarget(1, 1, { type: FloatType, depthBuffer: hasDepth, ...filters });
  }

  resize(target: RenderTarget, width: number, height: number): void {
    target.setSize(width, height);
  }

  drawSurfaces(target: RenderTarget, scene: Object3D, camera: Camera): void {
    this.#into(target, () => this.#renderer.render(scene, camera));
  }

  drawLight(target: RenderTarget, name: ScreenStage, light: LightShader, inputs: StageInputs): void {
    const stage = this.#stage(name, light, inputs);
    stage.surfaces.value = inputs.surfaces;
    if (stage.half && inputs.half) stage.half.value = inputs.half;
    this.#into(target, () => stage.quad.render(this.#renderer));
  }

  dispose(target: RenderTarget): void {
    target.dispose();
  }

  /** Draws to a target that is cleared to nothing, and leaves the renderer as it was. */
  #into(target: RenderTarget, draw: () => void): void {
    const renderer = this.#renderer;
    const [before, mrt, autoClear] = [renderer.getRenderTarget(), renderer.getMRT(), renderer.autoClear];
    const [face, level] = [renderer.getActiveCubeFace(), renderer.getActiveMipmapLevel()];
    const [color, alpha] = [renderer.getClearColor(new Color()), renderer.getClearAlpha()];
    renderer.setRenderTarget(target);
    renderer.setMRT(null);
    renderer.autoClear = true;
    renderer.setClearColor(0x000000, 0);
    draw();
    renderer.setClearColor(color, alpha);
    renderer.autoClear = autoClear;
    renderer.setMRT(mrt);
    renderer.setRenderTarget(before, face, level);
  }

  #stage(name: ScreenStage, light: LightShader, inputs: StageInputs): Stage {
    const stages = this.#stages.get(light) ?? new Map<ScreenStage, Stage>();
    this.#stages.set(light, stages);
    const stage = stages.get(name) ?? newStage(name, light, inputs);
    stages.set(name, stage);
    return stage;
  }
}

function newStage(name: ScreenStage, light: LightShader, inputs: StageInputs): Stage {
  const surfaces = texture(inputs.surfaces);
  const half = name === "upsample" ? texture(inputs.half as Texture) : undefined;
  const text = new ScreenTextNode(name, light, surfaces, half, inputs.constants);
  const material = new NodeMaterial();
  material.fragmentNode = vec4(new ScreenCallNode(text, name) as unknown as Node<"vec3">, 1);
  material.depthTest = material.depthWrite = false;
  material.blending = NoBlending;
  return { quad: new QuadMesh(material), surfaces, half };
}

/** What this module asks of a NodeBuilder; its types say less. */
type Builder = NodeBuilder & {
  readonly renderer: WebGPURenderer;
  getCodeFromNode(node: Node, type: string): { code: string };
  getFragCoord(): string;
};
type Built = Node & { build(builder: NodeBuilder, output?: string): string };

/** Functions of a stage, behind those of the light. */
class ScreenTextNode extends CodeNode {
  readonly #name: ScreenStage;
  readonly #light: Built;
  readonly #bindings: Readonly<Record<string, Built>>;

  static get type(): string {
    return "IrradiaScreenTextNode";
  }

  constructor(
    name: ScreenStage,
    light: LightShader,
    surfaces: TextureNode,
    half: TextureNode | undefined,
    constants: Float32Array,
  ) {
    super();
    this.#name = name;
    this.#light = lightNode(light, { position: vec3(0), normal: vec3(0) }) as unknown as Built;
    this.#bindings = {
      irradia_screen_surface: surfaces as unknown as Built,
      irradia_screen_view: buffer(constants, "vec4", constants.length / 4) as unknown as Built,
      ...(half && { irradia_screen_half: half as unknown as Built }),
    };
  }

  override generate(builder: Builder): string {
    this.#light.build(builder); // for its text; the call itself is thrown away
    const text = screenText(isWebGPU(builder.renderer) ? "wgsl" : "glsl", this.#name);
    const code = Object.entries(this.#bindings).reduce((result, [name, node]) => {
      return result.replaceAll(new RegExp(`\\b${name}\\b`, "g"), `${node.build(builder, "property")}`);
    }, text);
    builder.getCodeFromNode(this, "code").code = code;
    return code;
  }
}

/** E at the pixel that is drawn. */
class ScreenCallNode extends Node {
  static get type(): string {
    return "IrradiaScreenCallNode";
  }

  constructor(
    readonly text: ScreenTextNode,
    readonly stage: ScreenStage,
  ) {
    super("vec3");
  }

  override generate(builder: Builder): string {
    (this.text as unknown as Built).build(builder, "void");
    const vector = isWebGPU(builder.renderer) ? "vec2u" : "uvec2";
    return screenCall(this.stage, `${vector}( ${builder.getFragCoord()} )`);
  }
}

function isWebGPU({ backend }: WebGPURenderer): boolean {
  return "isWebGPUBackend" in backend;
}
