/** One frame: each side into its own target, then both onto the canvas. */
import type { View as LightView, SceneLight } from "@irradia/three/webgpu";
import type { Camera, RenderTarget, Scene, WebGPURenderer } from "three/webgpu";
import { FloatType } from "three/webgpu";
import type { Picture } from "../files/picture.js";
import type { View } from "../state/state.js";
import { Composite, type CompositeOptions } from "./composite.js";
import type { Difference } from "./error-picture.js";
import { automaticEv } from "./exposure.js";
import { FullScreen, makeTarget, texelOf } from "./quad.js";
import { ReferencePass } from "./reference-pass.js";

/** What one side shows. */
export type Side =
  | { readonly kind: "picture"; readonly picture: Picture }
  | { readonly kind: "light"; readonly source: string };

export interface FrameOptions extends Omit<CompositeOptions, "isDisplay"> {
  readonly left: Side;
  readonly right: Side;
  readonly view: View;
  readonly light: SceneLight | undefined;
}

/** Texels that automatic exposure looks at, across and down. */
const [METER_WIDTH, METER_HEIGHT] = [96, 54];
/** Views whose numbers are light, and so need exposure. */
const LIT_VIEWS: readonly View[] = ["light", "irradiance"];
const SAMPLES = 4;

export class Frame {
  readonly #renderer: WebGPURenderer;
  readonly #targets = [makeTarget(SAMPLES), makeTarget(SAMPLES)] as const;
  readonly #composite = new Composite(this.#targets[0].texture, this.#targets[1].texture);
  readonly #references = new ReferencePass();
  readonly #meter = {
    pass: new FullScreen(texelOf(this.#targets[0].texture)(0, 0)),
    target: makeTarget(0, FloatType),
  };

  constructor(renderer: WebGPURenderer) {
    this.#renderer = renderer;
    this.#meter.target.setSize(METER_WIDTH, METER_HEIGHT);
  }

  /** @param width pixels of the canvas, not of its layout */
  setSize(width: number, height: number): void {
    for (const target of this.#targets) target.setSize(width, height);
    this.#composite.setSize(width, height);
  }

  draw(scene: Scene, camera: Camera, options: FrameOptions, target: RenderTarget | null = null): void {
    this.#drawSide(0, options.left, scene, camera, options);
    if (options.compare !== "single") this.#drawSide(1, options.right, scene, camera, options);
    this.#composite.draw(this.#renderer, compositeOptions(options), target);
  }

  /** Stops for the left side as it was last drawn. */
  async meter(): Promise<number> {
    const { pass, target } = this.#meter;
    pass.draw(this.#renderer, target);
    const rgba = await this.#renderer.readRenderTargetPixelsAsync(target, 0, 0, METER_WIDTH, METER_HEIGHT);
    return automaticEv(rgba as unknown as Float32Array);
  }

  /** How far apart the sides are, as they were last drawn. */
  measure(options: FrameOptions): Promise<Difference> {
    return this.#composite.measure(this.#renderer, compositeOptions(options));
  }

  dispose(): void {
    for (const target of [...this.#targets, this.#meter.target]) target.dispose();
    this.#meter.pass.dispose();
    this.#composite.dispose();
    this.#references.dispose();
  }

  #drawSide(index: 0 | 1, side: Side, scene: Scene, camera: Camera, options: FrameOptions): void {
    const target = this.#targets[index];
    if (side.kind === "picture") {
      this.#references.draw(this.#renderer, side.picture, target);
      return;
    }
    const { light, view } = options;
    if (light) {
      light.use(side.source);
      light.view = lightView(view);
    }
    this.#renderer.setRenderTarget(target);
    this.#renderer.render(scene, camera);
    this.#renderer.setRenderTarget(null);
  }
}

function compositeOptions(options: FrameOptions): CompositeOptions {
  return { ...options, isDisplay: [isDisplay(options.left, options), isDisplay(options.right, options)] };
}

function isDisplay(side: Side, { view, light }: FrameOptions): boolean {
  if (side.kind === "picture") return !side.picture.isLinear;
  return light !== undefined && !LIT_VIEWS.includes(view);
}

/** The names of @irradia/three. */
export function lightView(view: View): LightView | null {
  if (view === "light") return null;
  if (view === "uv") return "lightmap-uv";
  return view === "position" ? "unit-position" : view;
}
