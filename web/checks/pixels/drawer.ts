/** One of three.js' renderers, as the checks use it. */
import type { TextureLimits } from "@irradia/runtime";
import type { IrradiaPlugin, SceneLight } from "@irradia/three";
import type { Camera, Scene } from "three";
import type { Backend, Channel, Picture } from "./request.js";

export interface Drawer {
  /** What really draws: WebGPURenderer falls back to WebGL2 without a word. */
  readonly backend: Backend;
  readonly limits: TextureLimits;
  /** Reads the light of files. */
  readonly plugin: IrradiaPlugin;
  /** Draws a frame; nobody waits for the GPU. */
  show(scene: Scene, camera: Camera, pass?: ScreenPass): void;
  /** Waits until all that was drawn is done. */
  finish(): Promise<void>;
  /** RGBA, linear, rows from the top; where nothing is, 0. */
  draw(scene: Scene, camera: Camera, pass?: ScreenPass): Promise<Float32Array>;
  /** Lets all materials of a scene show channels; the function it gives picks one, or none any more. */
  showChannels(scene: Scene): (channel: Channel | undefined) => void;
  newPass(light: SceneLight, how: Picture["how"]): ScreenPass | undefined;
}

/** What is drawn before a picture. */
export interface ScreenPass {
  render(scene: Scene, camera: Camera): boolean;
  dispose(): void;
}

/** Draws into a target, behind a pass. */
export function showFrame<Target>(
  renderer: {
    setRenderTarget(target: Target): void;
    clear(): void;
    render(scene: Scene, camera: Camera): void;
  },
  target: Target,
  scene: Scene,
  camera: Camera,
  pass: ScreenPass | undefined,
): void {
  renderer.setRenderTarget(target);
  pass?.render(scene, camera);
  renderer.clear();
  renderer.render(scene, camera);
}

/** By number in shaders; the first two leave the picture as it is. */
export const CHANNELS: readonly Channel[] = [
  "unlit",
  "white",
  "position",
  "normal",
  "surfaceNormal",
  "tangent",
  "lightmapUv",
];

/** Turns rows of four floats a pixel upside down. */
export function flipped(rgba: Float32Array, width: number, height: number): Float32Array {
  const rows = new Float32Array(rgba.length);
  for (let y = 0; y < height; y++) {
    rows.set(rgba.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
  }
  return rows;
}
