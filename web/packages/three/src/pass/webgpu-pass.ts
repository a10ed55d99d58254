/** Light evaluated once a pixel, for WebGPURenderer on either of its backends. */
import { type LightShader, type ScreenStage, screenText } from "@irradia/runtime";
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
import { buffer, texture, vec3, vec4 } from "three/tsl";
import {
  type Node,
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
import { languageOf, PixelLightNode, surfaceNode, TextNode } from "./nodes.js";

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
  readonly #stages = new Map<LightShader, Map<ScreenStage, Stage>>();

  constructor(renderer: WebGPURenderer) {
    this.#renderer = renderer;
  }

  get isBottomUp(): boolean {
    return languageOf(this.#renderer) === "glsl";
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
    copy.outputNode = surfaceNode();
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

  release(target: RenderTarget): void {
    target.dispose();
  }

  dispose(): void {
    const stages = [...this.#stages.values()].flatMap((ofLight) => [...ofLight.values()]);
    for (const { quad } of stages) (quad.material as Material).dispose();
    this.#stages.clear();
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
  const bindings = {
    irradia_screen_prepass: surfaces,
    irradia_screen_view: buffer(inputs.constants, "vec4", inputs.constants.length / 4),
    ...(half && { irradia_screen_half: half }),
  };
  const anywhere = { position: vec3(0), normal: vec3(0), surfaceNormal: vec3(0) };
  const text = new TextNode(
    (language) => screenText(language, name, light),
    bindings,
    lightNode(light, anywhere),
  );
  const material = new NodeMaterial();
  material.fragmentNode = vec4(new PixelLightNode(text, name) as unknown as Node<"vec3">, 1);
  material.depthTest = material.depthWrite = false;
  material.blending = NoBlending;
  return { quad: new QuadMesh(material), surfaces, half };
}
