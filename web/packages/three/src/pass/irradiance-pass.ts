/** Light evaluated once a pixel for the whole screen, before the scene is drawn: what both renderers share. */
import type { LightShader, ScreenStage } from "@irradia/runtime";
import { halfSize, isForScreens, screenConstants } from "@irradia/runtime";
import {
  type Camera,
  type Material,
  MeshBasicMaterial,
  NoBlending,
  type Object3D,
  type Texture,
  Vector2,
} from "three";
import { isSeeThrough } from "../core/see-through.js";
import { takesLight } from "../core/surfaces.js";
import type { SceneLight } from "../types.js";
import { exchangeMaterials } from "./undress.js";

/** How a pass works. */
export interface IrradiancePassOptions {
  /**
   * `full` evaluates the light once a pixel, whatever is drawn over what. `half` does so for every second pixel
   * of every second row and takes means between them; pixels without kin around them, at edges, are evaluated
   * as well. `full` is the default.
   */
  readonly resolution?: "full" | "half" | undefined;
}

/** A target that has just been drawn. */
export interface DrawnTarget {
  readonly texture: Texture;
}

/** What renderers do each in its own way. */
export interface PassDrawer<Target extends DrawnTarget> {
  readonly isBottomUp: boolean;
  /** Of what is drawn next. */
  sizeTo(size: Vector2): void;
  /** Writes normals and distances of what an opaque material shows. */
  surfaceMaterial(original: Material): Material;
  /** RGBA in floats; with a buffer of depths where surfaces are drawn to it. */
  newTarget(hasDepth: boolean): Target;
  resize(target: Target, width: number, height: number): void;
  drawSurfaces(target: Target, scene: Object3D, camera: Camera): void;
  drawLight(target: Target, stage: ScreenStage, light: LightShader, inputs: StageInputs): void;
  /** Frees a target. */
  release(target: Target): void;
  /** Frees what it draws light with. */
  dispose(): void;
}

/** What a stage reads. */
export interface StageInputs {
  readonly surfaces: Texture;
  /** Of stage `half`, for stage `upsample`. */
  readonly half: Texture | undefined;
  readonly constants: Float32Array;
}

/** A copy of a material that draws nothing but numbers. */
export function plainCopy(original: Material): Material {
  const copy = original.clone();
  copy.blending = NoBlending;
  copy.alphaToCoverage = false;
  if ("transmission" in copy) copy.transmission = 0; // else the scene would be drawn once more behind it
  return copy;
}

/** See the renderers' IrradiancePass. */
export abstract class BaseIrradiancePass<Target extends DrawnTarget> {
  readonly #drawer: PassDrawer<Target>;
  readonly #light: SceneLight;
  readonly #isHalf: boolean;
  readonly #size = new Vector2();
  readonly #constants = new Float32Array(24);
  readonly #surfaces: Target;
  readonly #irradiance: Target;
  readonly #half: Target | undefined;
  readonly #materials = new Map<Material, Material>();
  readonly #hidden = new MeshBasicMaterial({ visible: false });
  #version: number;

  protected constructor(
    drawer: PassDrawer<Target>,
    light: SceneLight,
    { resolution = "full" }: IrradiancePassOptions,
  ) {
    this.#drawer = drawer;
    this.#light = light;
    this.#isHalf = resolution === "half";
    this.#surfaces = drawer.newTarget(true);
    this.#irradiance = drawer.newTarget(false);
    this.#half = this.#isHalf ? drawer.newTarget(false) : undefined;
    this.#version = light.version;
  }

  /**
   * Evaluates the light of what the camera sees, and gives it to the scene's materials until the next call. To
   * be called before each frame, with the renderer's target set to what the frame will be drawn to.
   *
   * @returns whether the pass lights the frame: sources that need more than position and normals, such as
   *   lightmaps, are left to the materials, and so are debug views
   */
  render(scene: Object3D, camera: Camera): boolean {
    const { bare } = this.#light.source;
    if (!bare || !isForScreens(bare) || this.#light.view !== null) {
      this.#light.screen = null;
      return false;
    }
    this.#resize();
    this.#drawSurfaces(scene, camera);
    this.#drawLight(bare, camera);
    this.#light.screen = this.#irradiance.texture;
    return true;
  }

  /**
   * Gives the light back to the materials, and frees what the pass holds. To leave it out for a while, set the
   * light's `screen` to null instead: making a pass anew compiles its shaders anew.
   */
  dispose(): void {
    this.#light.screen = null;
    for (const target of [this.#surfaces, this.#irradiance, this.#half])
      if (target) this.#drawer.release(target);
    this.#forgetMaterials();
    this.#hidden.dispose();
    this.#drawer.dispose();
  }

  /** Of materials that may have changed since. */
  #forgetMaterials(): void {
    for (const material of this.#materials.values()) material.dispose();
    this.#materials.clear();
  }

  #resize(): void {
    this.#drawer.sizeTo(this.#size);
    const { x, y } = this.#size;
    this.#drawer.resize(this.#surfaces, x, y);
    this.#drawer.resize(this.#irradiance, x, y);
    if (this.#half) this.#drawer.resize(this.#half, halfSize(x), halfSize(y));
  }

  #drawSurfaces(scene: Object3D, camera: Camera): void {
    if (this.#version !== this.#light.version) this.#forgetMaterials();
    this.#version = this.#light.version;
    const lit = new Set<Object3D>(this.#light.surfaces.map(({ mesh }) => mesh));
    const restore = exchangeMaterials(scene, (worn, mesh) => {
      const original = this.#light.originalOf(worn);
      const isBehind = this.#light.surfacesAs === "baked" && isSeeThrough(original); // shows what stands there
      return lit.has(mesh) && takesLight(original) && !isBehind
        ? this.#surfaceMaterial(original)
        : this.#hidden;
    });
    try {
      this.#drawer.drawSurfaces(this.#surfaces, scene, camera);
    } finally {
      restore();
    }
  }

  #surfaceMaterial(original: Material): Material {
    const material = this.#materials.get(original) ?? this.#drawer.surfaceMaterial(original);
    this.#materials.set(original, material);
    return material;
  }

  #drawLight(shader: LightShader, { projectionMatrix, matrixWorld }: Camera): void {
    const [width, height] = this.#size.toArray();
    const { isBottomUp } = this.#drawer;
    const matrices = { projection: projectionMatrix.elements, worldFromView: matrixWorld.elements };
    screenConstants({ width, height, isBottomUp, ...matrices }, this.#constants);
    const inputs = {
      surfaces: this.#surfaces.texture,
      half: this.#half?.texture,
      constants: this.#constants,
    };
    if (this.#half) this.#drawer.drawLight(this.#half, "half", shader, { ...inputs, half: undefined });
    this.#drawer.drawLight(this.#irradiance, this.#half ? "upsample" : "full", shader, inputs);
  }
}
