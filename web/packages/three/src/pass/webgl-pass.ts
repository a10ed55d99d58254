/** Light evaluated once a pixel, for WebGLRenderer. */
import { type LightShader, prepassText, type ScreenStage, screenCall, screenText } from "@irradia/runtime";
import {
  BufferGeometry,
  Camera,
  Color,
  Float32BufferAttribute,
  FloatType,
  GLSL3,
  type IUniform,
  type Material,
  Mesh,
  NearestFilter,
  NoBlending,
  type Object3D,
  ShaderMaterial,
  type Vector2,
  type WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import type { SceneLight } from "../types.js";
import { bindGlsl } from "../webgl/bind.js";
import {
  BaseIrradiancePass,
  type IrradiancePassOptions,
  type PassDrawer,
  plainCopy,
  type StageInputs,
} from "./irradiance-pass.js";

export type { IrradiancePassOptions } from "./irradiance-pass.js";

/**
 * Evaluates the light once a pixel, which decouples its cost from overdraw and, at half resolution, from most
 * of the pixels.
 *
 *     const pass = new IrradiancePass(renderer, light, { resolution: "half" });
 *     // each frame
 *     pass.render(scene, camera);
 *     renderer.render(scene, camera);
 *
 * Needs EXT_color_buffer_float. Transparent materials take no baked light, here as without the pass.
 */
export class IrradiancePass extends BaseIrradiancePass<WebGLRenderTarget> {
  constructor(renderer: WebGLRenderer, light: SceneLight, options: IrradiancePassOptions = {}) {
    super(new WebGLPassDrawer(renderer), light, options);
  }
}

/** A triangle over the whole screen. */
const TRIANGLE = /*@__PURE__*/ new BufferGeometry().setAttribute(
  "position",
  /*@__PURE__*/ new Float32BufferAttribute([-1, -1, 0, 3, -1, 0, -1, 3, 0], 3),
);
const VERTEX = "void main() { gl_Position = vec4(position, 1.0); }";

/** Behind normal maps; what follows is never reached, and compilers leave it out. */
const SURFACE = `
mat3 irradiaWorldFromView = transpose(mat3(viewMatrix));
gl_FragColor = irradia_screen_packed(
  normalize(irradiaWorldFromView * normal), normalize(irradiaWorldFromView * nonPerturbedNormal), vViewPosition.z);
return;`;

interface Stage {
  readonly mesh: Mesh<BufferGeometry, ShaderMaterial>;
  readonly surfaces: IUniform;
  readonly half: IUniform;
  readonly constants: IUniform;
}

class WebGLPassDrawer implements PassDrawer<WebGLRenderTarget> {
  readonly isBottomUp = true;
  readonly #renderer: WebGLRenderer;
  readonly #camera = new Camera();
  readonly #stages = new Map<LightShader, Map<ScreenStage, Stage>>();

  constructor(renderer: WebGLRenderer) {
    this.#renderer = renderer;
  }

  sizeTo(size: Vector2): void {
    const target = this.#renderer.getRenderTarget();
    if (target) size.set(target.width, target.height);
    else this.#renderer.getDrawingBufferSize(size);
  }

  surfaceMaterial(original: Material): Material {
    const copy = plainCopy(original);
    copy.onBeforeCompile = (program, renderer) => {
      original.onBeforeCompile(program, renderer);
      const insert = (chunk: string, text: string): void => {
        program.fragmentShader = program.fragmentShader.replace(chunk, `${chunk}\n${text}`);
      };
      insert("#include <common>", prepassText("glsl"));
      insert("#include <normal_fragment_maps>", SURFACE);
    };
    copy.customProgramCacheKey = () => `${original.customProgramCacheKey()}|irradia-surface`;
    return copy;
  }

  newTarget(hasDepth: boolean): WebGLRenderTarget {
    const filters = { minFilter: NearestFilter, magFilter: NearestFilter };
    return new WebGLRenderTarget(1, 1, { type: FloatType, depthBuffer: hasDepth, ...filters });
  }

  resize(target: WebGLRenderTarget, width: number, height: number): void {
    target.setSize(width, height);
  }

  drawSurfaces(target: WebGLRenderTarget, scene: Object3D, camera: Camera): void {
    this.#into(target, () => {
      const [color, alpha] = [this.#renderer.getClearColor(new Color()), this.#renderer.getClearAlpha()];
      this.#renderer.setClearColor(0x000000, 0);
      this.#renderer.clear();
      this.#renderer.render(scene, camera);
      this.#renderer.setClearColor(color, alpha);
    });
  }

  drawLight(target: WebGLRenderTarget, name: ScreenStage, light: LightShader, inputs: StageInputs): void {
    const stage = this.#stage(name, light);
    stage.surfaces.value = inputs.surfaces;
    stage.half.value = inputs.half;
    stage.constants.value = inputs.constants;
    this.#into(target, () => this.#renderer.render(stage.mesh, this.#camera));
  }

  release(target: WebGLRenderTarget): void {
    target.dispose();
  }

  dispose(): void {
    const stages = [...this.#stages.values()].flatMap((ofLight) => [...ofLight.values()]);
    for (const { mesh } of stages) mesh.material.dispose();
    this.#stages.clear();
  }

  /** Draws to a target without shadows and without headsets, and leaves the renderer as it was. */
  #into(target: WebGLRenderTarget, draw: () => void): void {
    const { shadowMap, xr, autoClear } = this.#renderer;
    const before = { target: this.#renderer.getRenderTarget(), xr: xr.enabled, ...shadowMap };
    const face = this.#renderer.getActiveCubeFace();
    const level = this.#renderer.getActiveMipmapLevel();
    xr.enabled = false;
    shadowMap.autoUpdate = false;
    shadowMap.needsUpdate = false;
    this.#renderer.autoClear = false;
    this.#renderer.setRenderTarget(target);
    draw();
    this.#renderer.setRenderTarget(before.target, face, level);
    this.#renderer.autoClear = autoClear;
    shadowMap.autoUpdate = before.autoUpdate;
    shadowMap.needsUpdate = before.needsUpdate;
    xr.enabled = before.xr;
  }

  #stage(name: ScreenStage, light: LightShader): Stage {
    const stages = this.#stages.get(light) ?? new Map<ScreenStage, Stage>();
    this.#stages.set(light, stages);
    const stage = stages.get(name) ?? newStage(name, light);
    stages.set(name, stage);
    return stage;
  }
}

function newStage(name: ScreenStage, light: LightShader): Stage {
  const { text, uniforms } = bindGlsl(light);
  const [surfaces, half, constants] = [emptyUniform(), emptyUniform(), emptyUniform()];
  const own = { irradia_screen_prepass: surfaces, irradia_screen_half: half, irradia_screen_view: constants };
  const material = new ShaderMaterial({
    glslVersion: GLSL3,
    uniforms: { ...uniforms, ...own },
    vertexShader: VERTEX,
    fragmentShader: fragment(name, light, text),
    depthTest: false,
    depthWrite: false,
    blending: NoBlending,
    toneMapped: false,
  });
  const mesh = new Mesh(TRIANGLE, material);
  mesh.frustumCulled = false;
  return { mesh, surfaces, half, constants };
}

function emptyUniform(): IUniform {
  return { value: null };
}

function fragment(name: ScreenStage, light: LightShader, text: string): string {
  return `
uniform highp sampler2D irradia_screen_prepass;
uniform highp sampler2D irradia_screen_half;
uniform vec4 irradia_screen_view[6];
layout(location = 0) out highp vec4 irradiance;
${text}
${screenText("glsl", name, light)}
void main() { irradiance = vec4(${screenCall(name, "uvec2(gl_FragCoord.xy)")}, 1.0); }`;
}
