/** Light evaluated once a pixel, by what a prepass says of the surface there. */
import { composeText } from "./compose.js";
import type { LightInput, LightShader, ShaderLanguage } from "./light-shader.js";

/**
 * What a full-screen pass writes: E at each pixel, E at every second pixel of every second row, or E at each
 * pixel from the latter.
 */
export type ScreenStage = "full" | "half" | "upsample";

/** Calls that give E, by stage, for a pixel as two unsigned integers. */
const CALLS: Readonly<Record<ScreenStage, (pixel: string) => string>> = {
  full: (pixel) => `irradia_screen_irradiance(${pixel})`,
  half: (pixel) => `irradia_screen_irradiance(irradia_screen_sample(${pixel}))`,
  upsample: (pixel) => `irradia_screen_upsampled(${pixel})`,
};

/** Inputs that a prepass stores, by the names of their parameters. */
const STORED: Readonly<Partial<Record<LightInput, string>>> = {
  position: "position",
  normal: "normal",
  surfaceNormal: "surface_normal",
};

/** Whether a source can be evaluated from what a prepass stores: no map, no tangents. */
export function isForScreens({ inputs }: LightShader): boolean {
  return inputs.every((input) => STORED[input]);
}

/**
 * Functions that write what a prepass stores: `irradia_screen_packed(normal, surface_normal, depth) -> vec4`, of
 * unit vectors in world space and the distance along the view in metres.
 */
export function prepassText(language: ShaderLanguage): string {
  return composeText(language, ["screen-surface"]);
}

/**
 * Functions of a stage, to be put behind the text of a source for which `isForScreens`.
 *
 * They read the prepass as `irradia_screen_prepass`, light at half resolution as `irradia_screen_half`, and
 * `screenConstants` as `irradia_screen_view`: two-dimensional textures of floats and an array of six vec4s.
 */
export function screenText(language: ShaderLanguage, stage: ScreenStage, light: LightShader): string {
  const call = `${light.entry}(${light.inputs.map((input) => STORED[input]).join(", ")})`;
  const names = Object.values(STORED);
  const wrapper =
    language === "wgsl"
      ? `fn irradia_screen_light(${names.map((name) => `${name}: vec3f`).join(", ")}) -> vec3f { return ${call}; }`
      : `vec3 irradia_screen_light(${names.map((name) => `vec3 ${name}`).join(", ")}) { return ${call}; }`;
  return composeText(language, [{ text: wrapper }, stage === "upsample" ? "screen-upsample" : "screen"]);
}

/** The expression of a stage's light at a pixel. */
export function screenCall(stage: ScreenStage, pixel: string): string {
  return CALLS[stage](pixel);
}

/** Texels along one side of the target of half resolution: one more than half, for pixels at the edge. */
export function halfSize(size: number): number {
  return (size >> 1) + 1;
}

/** How pixels see, in the order of matrices of glTF and WebGL: column by column. */
export interface ScreenView {
  readonly width: number;
  readonly height: number;
  /** clip_from_view. */
  readonly projection: readonly number[];
  readonly worldFromView: readonly number[];
  /** Whether row 0 of targets is the bottom, as in WebGL. */
  readonly isBottomUp: boolean;
}

/** Writes `irradia_screen_view`, which shaders/wgsl/screen.wgsl describes. */
export function screenConstants(view: ScreenView, constants: Float32Array): void {
  const { width, height, projection, worldFromView, isBottomUp } = view;
  const at = (i: number): number => projection[i] ?? 0;
  const isParallel = at(15) === 1;
  const up = isBottomUp ? 1 : -1;
  const shift = (axis: number): number => (isParallel ? -at(12 + axis) : at(8 + axis));
  const slope = [(1 / width - 1 + shift(0)) / at(0), (up * (1 / height - 1) + shift(1)) / at(5)];
  const steps = [2 / (width * at(0)), (2 * up) / (height * at(5))];
  constants.set([...slope, ...steps, isParallel ? 1 : 0, 0, width, height]);
  constants.set(worldFromView, 8);
}
