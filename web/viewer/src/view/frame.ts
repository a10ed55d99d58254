/** One frame: each side into its own target, then both onto the canvas. */
import { IrradiancePass, type View as LightView, type SceneLight } from "@irradia/three/webgpu";
import { type Camera, FloatType, type Scene, type WebGPURenderer } from "three/webgpu";
import type { Picture } from "../files/picture.js";
import type { Pass, Surfaces, View } from "../state/state.js";
import { Composite, type CompositeOptions } from "./composite.js";
import type { Difference } from "./difference.js";
import { automaticEv } from "./exposure.js";
import { FullScreen, makeTarget, texelOf } from "./quad.js";
import { ReferencePass } from "./reference-pass.js";
import type { Reading } from "./tone.js";

/** What one side shows. */
export type Side =
  | { readonly kind: "picture"; readonly picture: Picture }
  | { readonly kind: "light"; readonly source: string };

export interface FrameOptions extends Omit<CompositeOptions, "readings"> {
  readonly left: Side;
  readonly right: Side;
  readonly view: View;
  readonly surfaces: Surfaces;
  readonly pass: Pass;
  readonly light: SceneLight;
}

/** Texels that automatic exposure looks at, across and down. */
const [METER_WIDTH, METER_HEIGHT] = [96, 54];
const SAMPLES = 4;

export class Frame {
  readonly #renderer: WebGPURenderer;
  readonly #targets = [makeTarget(SAMPLES), makeTarget(SAMPLES)] as const;
  readonly #composite = new Composite(this.#targets[0].texture, this.#targets[1].texture);
  readonly #references = new ReferencePass();
  readonly #meterPass = new FullScreen(texelOf(this.#targets[0].texture)(0, 0));
  readonly #meterTarget = makeTarget(0, FloatType);
  #pass: { readonly pass: IrradiancePass; readonly light: SceneLight; readonly kind: Pass } | undefined;

  constructor(renderer: WebGPURenderer) {
    this.#renderer = renderer;
    this.#meterTarget.setSize(METER_WIDTH, METER_HEIGHT);
  }

  /** @param width pixels of the canvas, not of its layout */
  setSize(width: number, height: number): void {
    for (const target of this.#targets) target.setSize(width, height);
    this.#composite.setSize(width, height);
  }

  draw(scene: Scene, camera: Camera, options: FrameOptions): void {
    this.drawSides(scene, camera, options);
    this.compose(options);
  }

  /** Leaves the canvas as it is. */
  drawSides(scene: Scene, camera: Camera, options: FrameOptions): void {
    this.#drawSide(0, options.left, scene, camera, options);
    if (options.compare !== "single") this.#drawSide(1, options.right, scene, camera, options);
  }

  /** The sides as they were last drawn, onto the canvas. */
  compose(options: FrameOptions): void {
    this.#composite.draw(this.#renderer, compositeOptions(options));
  }

  /** Stops for the left side as it was last drawn. */
  async meter(): Promise<number> {
    this.#meterPass.draw(this.#renderer, this.#meterTarget);
    const size = [METER_WIDTH, METER_HEIGHT] as const;
    const rgba = await this.#renderer.readRenderTargetPixelsAsync(this.#meterTarget, 0, 0, ...size);
    return automaticEv(rgba as unknown as Float32Array);
  }

  /** How far apart the sides are, as they were last drawn; null where they have no pixel in common. */
  measure(options: FrameOptions): Promise<Difference | null> {
    return this.#composite.measure(this.#renderer, compositeOptions(options));
  }

  dispose(): void {
    for (const target of [...this.#targets, this.#meterTarget]) target.dispose();
    this.#meterPass.dispose();
    this.#composite.dispose();
    this.#references.dispose();
    this.#pass?.pass.dispose();
  }

  #drawSide(index: 0 | 1, side: Side, scene: Scene, camera: Camera, options: FrameOptions): void {
    const target = this.#targets[index];
    if (side.kind === "picture") {
      this.#references.draw(this.#renderer, side.picture, target);
      return;
    }
    const { light, pass } = options;
    showSource(side.source, options);
    this.#renderer.setRenderTarget(target);
    this.#passFor(light, pass)?.render(scene, camera);
    this.#renderer.render(scene, camera);
    this.#renderer.setRenderTarget(null);
  }

  #passFor(light: SceneLight, kind: Pass): IrradiancePass | undefined {
    if (this.#pass && (this.#pass.light !== light || this.#pass.kind !== kind)) {
      this.#pass.pass.dispose();
      this.#pass = undefined;
    }
    if (kind === "inline") return undefined;
    this.#pass ??= { pass: new IrradiancePass(this.#renderer, light, { resolution: kind }), light, kind };
    return this.#pass.pass;
  }
}

/**
 * What moves takes the same light as the rest, where that is to be had everywhere; the light's screen is its pass's
 * affair. A file that nothing was baked for is what its materials say.
 */
function showSource(source: string, { light, view, surfaces, pass }: FrameOptions): void {
  const mobile = light.sources.filter(({ isDynamic }) => isDynamic);
  const dynamic = source === "none" ? undefined : (mobile.find(({ name }) => name === source) ?? mobile[0]);
  light.show({
    source,
    dynamicSource: dynamic?.name ?? null,
    view: lightView(view),
    surfacesAs: light.sources.length > 1 ? surfaces : "materials",
    ...(pass === "inline" ? { screen: null } : {}),
  });
}

/** Whether a view's numbers are light, and so need exposure. */
export function isLit(view: View): boolean {
  return view === "light" || view === "irradiance" || view === "unclamped";
}

function compositeOptions(options: FrameOptions): CompositeOptions {
  const { left, right, view } = options;
  return { ...options, readings: [readingOf(left, view), readingOf(right, view)] };
}

function readingOf(side: Side, view: View): Reading {
  if (side.kind === "picture") return side.picture.isLinear ? "light" : "display";
  if (view === "unclamped") return "irradiance";
  if (view === "raw") return "signed";
  return isLit(view) ? "light" : "display";
}

/** A view by its name in @irradia/three; null is the picture. */
export function lightView(view: View): LightView | null {
  if (view === "light") return null;
  if (view === "uv") return "lightmap-uv";
  return view === "position" ? "unit-position" : view;
}
