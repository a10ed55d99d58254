/** FLIP and squared error of what a display shows of both sides. */

import { clamp, dot, float, min, mix, step, vec3, vec4 } from "three/tsl";
import { FloatType, type Node, type RenderTarget, type WebGPURenderer } from "three/webgpu";
import type { Tone } from "../state/state.js";
import { type Difference, differenceOf } from "./difference.js";
import { colourColumn, colourRow, featureColumn, featureRow, flipError, opponent } from "./flip.js";
import { colourKernels, featureKernels } from "./flip-kernels.js";
import { FullScreen, makeTarget, texelOf } from "./quad.js";
import { displayed, type SideNodes, srgb } from "./tone.js";

interface Step {
  readonly pass: FullScreen;
  readonly target: RenderTarget;
}

/** Made for one tone curve; the filters are FLIP's own, split into rows and columns. */
export class ErrorPicture {
  /** FLIP, mean squared error of the channels, nothing, and 1 where both sides show something. */
  readonly result = makeTarget(0, FloatType);
  readonly #steps: Step[] = [];

  constructor(left: SideNodes, right: SideNodes, tone: Tone, exposure: Node<"float">) {
    const colour = colourKernels();
    const feature = featureKernels();
    const sides = [left, right].map((side) => {
      const shown = displayed(side, tone, exposure);
      const over = mix(vec3(0), shown.rgb, clamp(shown.a, 0, 1));
      const base = this.#step(vec4(opponent(over), shown.a));
      const rows = this.#step(colourRow(texelOf(base.texture), colour));
      const edges = this.#step(featureRow(texelOf(base.texture), feature));
      const filtered = colourColumn(texelOf(rows.texture), colour);
      const features = featureColumn(texelOf(edges.texture), feature);
      return { over, alpha: shown.a, filtered, features };
    });
    const [one, other] = sides as [(typeof sides)[0], (typeof sides)[0]];
    const flip = flipError([one.filtered, other.filtered], [one.features, other.features]);
    const apart = srgb(one.over).sub(srgb(other.over));
    const both = step(float(0.5), min(one.alpha, other.alpha));
    this.#steps.push({
      pass: new FullScreen(vec4(flip, dot(apart, apart).div(3), 0, both)),
      target: this.result,
    });
  }

  setSize(width: number, height: number): void {
    for (const { target } of this.#steps) target.setSize(width, height);
  }

  draw(renderer: WebGPURenderer): void {
    for (const { pass, target } of this.#steps) pass.draw(renderer, target);
  }

  /** Draws, waits for the GPU and averages. */
  async measure(renderer: WebGPURenderer): Promise<Difference | null> {
    this.draw(renderer);
    const { width, height } = this.result;
    const rgba = await renderer.readRenderTargetPixelsAsync(this.result, 0, 0, width, height);
    return differenceOf(rgba as unknown as Float32Array);
  }

  dispose(): void {
    for (const { pass, target } of this.#steps) {
      pass.dispose();
      target.dispose();
    }
  }

  #step(fragment: Node<"vec4">): RenderTarget {
    const step = { pass: new FullScreen(fragment), target: makeTarget() };
    this.#steps.push(step);
    return step.target;
  }
}
