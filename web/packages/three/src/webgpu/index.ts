/** Irradia's baked light in three.js' WebGPURenderer, on both its backends; `@irradia/three` is for WebGLRenderer. */
import type { Precision } from "@irradia/runtime";
import { COMMON_BLOCK_LIMITS } from "../core/limits.js";
import { pluginOf } from "../core/plugin.js";
import type { IrradiaOptions, IrradiaPlugin } from "../types.js";
import { WebGPUPainter } from "./painter.js";

export { IrradiancePass, type IrradiancePassOptions } from "../pass/webgpu-pass.js";
export type {
  DirectFrom,
  Inputs,
  IrradiaOptions,
  IrradiaPlugin,
  LightSource,
  LitSurface,
  SceneLight,
  Shown,
  SourceKind,
  SurfacesAs,
  View,
} from "../types.js";
export { LIGHTMAP_ATTRIBUTES } from "../types.js";
export { lightNode } from "./bind.js";
export { lightmapPlace } from "./inputs.js";
export { limitsOf, precisionOf } from "./limits.js";

/** What to know before a file is there. */
export interface WebGPUOptions extends IrradiaOptions {
  /**
   * Of the perceptron of the file's field. `half` needs a device with `shader-f16`: `precisionOf(renderer)` is that
   * where there is one, and `float`, the default, elsewhere.
   */
  readonly precision?: Precision | undefined;
}
export { readyUnzstd } from "../core/unzstd.js";

/**
 * A plugin for GLTFLoader: `new GLTFLoader().register(irradia())`. The scene that comes is lit; its light is at
 * `gltf.userData.irradia`.
 */
export function irradia(options: WebGPUOptions = {}): IrradiaPlugin {
  const { limits = COMMON_BLOCK_LIMITS, precision } = options;
  return pluginOf(options, () => new WebGPUPainter(limits, precision));
}
