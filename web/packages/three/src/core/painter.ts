/** What the two renderers do differently. */
import type { LightShader, Precision, Probes, TextureLimits } from "@irradia/runtime";
import type { Data3DTexture, DataArrayTexture, Light, Material, Texture } from "three";
import type { View } from "../types.js";
import type { Lamps } from "./lamps.js";
import type { ShadowMask } from "./shadow-mask.js";

/** The most that the bake lets a surface reflect. */
export const MAX_REFLECTANCE = 0.98;

/** Of a surface as the bake saw it: all of it; of one that is see-through its own light, or the tint of what passes. */
export type BakedPart = "whole" | "added" | "passed";

/** How a material is to show its light. */
export interface Shading {
  /** Whence E comes; undefined is no light of ours. */
  readonly light: LightShader | ScreenLight | GridLight | undefined;
  /** Direct light that a screen light leaves to the material. */
  readonly direct: LightShader | undefined;
  /** Lights that this light leaves out and that don't shine by themselves. */
  readonly lamps: Lamps | undefined;
  readonly view: View | null;
  /** Undefined is three.js' own shading. */
  readonly baked: BakedPart | undefined;
  /** What lights see-through surfaces, if they are as the bake saw them: screens show what stands behind. */
  readonly seeThrough: LightShader | GridLight | undefined;
  /** Baked shadows of live lights. */
  readonly mask: ShadowMask | undefined;
  /** What the view of this name shows, where the lightmap is what is shown. */
  readonly validity: DataArrayTexture | undefined;
  /** Width and height of the page, where geometries drawn with it carry LIGHTMAP_ATTRIBUTES. */
  readonly lightmap: readonly [number, number] | undefined;
}

/** Texels of the lightmap along a field of the checker that shows its uv. */
export const CHECKER_TEXELS = 4;

/** E by pixel; `texture` may be exchanged while materials draw with it. */
export class ScreenLight {
  constructor(public texture: Texture) {}
}

/** three.js' own grid of light probes, which stands in the scene and adds its light by itself. */
export class GridLight {
  constructor(
    readonly grid: Light,
    readonly texture: Data3DTexture,
  ) {}

  get nBytes(): number {
    return this.texture.image.data?.byteLength ?? 0;
  }

  dispose(): void {
    this.grid.removeFromParent();
    this.grid.dispose();
    this.texture.dispose();
  }
}

/** Writes light into materials; one for each scene. */
export interface Painter {
  readonly limits: TextureLimits;
  /** Of fields' perceptrons; floats where absent. */
  readonly precision?: Precision;
  /** Factor on E, read at each frame. */
  intensity: number;
  /**
   * Makes a fresh copy of `original` show its light so.
   *
   * @param key the same for the same shading, and for no other
   */
  paint(copy: Material, original: Material, shading: Shading, key: string): void;
  /** The texture behind a screen light was exchanged. */
  screenChanged(screen: ScreenLight): void;
  /** Once, before anything is drawn: lights that have baked shadows. Gives what undoes it. */
  shadow(mask: ShadowMask): () => void;
  /** three.js' own grid of light probes, filled from a grid of ours. */
  probeGrid(probes: Probes): GridLight;
}
