/** The last pass: both sides' light becomes the picture on the canvas. */
import {
  abs,
  clamp,
  float,
  fract,
  mix,
  screenUV,
  select,
  step,
  texture,
  uniform,
  vec3,
  vec4,
} from "three/tsl";
import type { Node, RenderTarget, Texture, WebGPURenderer } from "three/webgpu";
import type { Comparison, Tone } from "../state/state.js";
import type { Difference } from "./difference.js";
import { ErrorPicture } from "./error-picture.js";
import { FullScreen } from "./quad.js";
import { coded, displayed, type Reading, ReadSide, type SideNodes } from "./tone.js";

/** Of FLIP from 0 to 1, sRGB: those of our reports. */
const ERROR_COLOURS = [
  [4, 4, 10],
  [44, 18, 92],
  [112, 30, 124],
  [186, 54, 102],
  [240, 106, 68],
  [252, 176, 92],
  [252, 246, 196],
] as const;

export interface CompositeOptions {
  readonly compare: Comparison;
  readonly tone: Tone;
  readonly ev: number;
  readonly split: number;
  readonly gain: number;
  /** What the sides' numbers are. */
  readonly readings: readonly [left: Reading, right: Reading];
}

export class Composite {
  readonly #exposure = uniform(1);
  readonly #split = uniform(0.5);
  readonly #gain = uniform(1);
  readonly #left: ReadSide;
  readonly #right: ReadSide;
  readonly #passes = new Map<string, FullScreen>();
  readonly #errors = new Map<Tone, ErrorPicture>();
  #size: readonly [number, number] = [1, 1];

  constructor(left: Texture, right: Texture) {
    this.#left = new ReadSide(left);
    this.#right = new ReadSide(right);
  }

  setSize(width: number, height: number): void {
    this.#size = [width, height];
    for (const error of this.#errors.values()) error.setSize(width, height);
  }

  /** @param target null is the canvas */
  draw(renderer: WebGPURenderer, options: CompositeOptions, target: RenderTarget | null = null): void {
    this.#bind(options);
    if (options.compare === "error") this.#error(options.tone).draw(renderer);
    this.#pass(options).draw(renderer, target);
  }

  /** How far the sides are apart, as a display shows them; null where they have no pixel in common. */
  async measure(renderer: WebGPURenderer, options: CompositeOptions): Promise<Difference | null> {
    this.#bind(options);
    return this.#error(options.tone).measure(renderer);
  }

  dispose(): void {
    for (const pass of this.#passes.values()) pass.dispose();
    for (const error of this.#errors.values()) error.dispose();
  }

  #bind({ ev, split, gain, readings }: CompositeOptions): void {
    this.#exposure.value = 2 ** ev;
    this.#split.value = split;
    this.#gain.value = gain;
    this.#left.reading = readings[0];
    this.#right.reading = readings[1];
  }

  #pass({ compare, tone }: CompositeOptions): FullScreen {
    const key = `${compare} ${tone}`;
    const made = this.#passes.get(key) ?? new FullScreen(vec4(this.#colour(compare, tone), 1));
    this.#passes.set(key, made);
    return made;
  }

  #colour(compare: Comparison, tone: Tone): Node<"vec3"> {
    const side = (nodes: SideNodes): Node<"vec3"> => coded(displayed(nodes, tone, this.#exposure));
    if (compare === "single") return side(this.#left);
    if (compare === "error") return this.#errorColour(tone);
    if (compare === "difference") return abs(side(this.#left).sub(side(this.#right))).mul(this.#gain);
    const isRight = step(this.#split, screenUV.x);
    return mix(side(this.#left), side(this.#right), isRight);
  }

  #errorColour(tone: Tone): Node<"vec3"> {
    const error = texture(this.#error(tone).result.texture, screenUV);
    const place = clamp(error.x, 0, 1).mul(ERROR_COLOURS.length - 1);
    let colour: Node<"vec3"> = shade(0);
    for (let i = 1; i < ERROR_COLOURS.length; i += 1) {
      colour = select(
        place.greaterThan(i - 1),
        mix(shade(i - 1), shade(i), clamp(place.sub(i - 1), 0, 1)),
        colour,
      );
    }
    return mix(hatch(), colour, error.w);
  }

  #error(tone: Tone): ErrorPicture {
    const made = this.#errors.get(tone) ?? new ErrorPicture(this.#left, this.#right, tone, this.#exposure);
    if (!this.#errors.has(tone)) made.setSize(...this.#size);
    this.#errors.set(tone, made);
    return made;
  }
}

function shade(index: number): Node<"vec3"> {
  const [r, g, b] = ERROR_COLOURS[index] ?? ERROR_COLOURS[0];
  return vec3(r / 255, g / 255, b / 255);
}

/** Where a side shows nothing there is nothing to compare. */
function hatch(): Node<"vec3"> {
  const stripes = step(float(0.5), fract(screenUV.x.add(screenUV.y).mul(40)));
  return vec3(stripes.mul(0.02).add(0.09));
}
