/** Irradia's baked light in three.js' WebGPURenderer, on both its backends; `@irradia/three` is for WebGLRenderer. */
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
  View,
} from "../types.js";
export { LIGHTMAP_ATTRIBUTES } from "../types.js";
export { lightNode } from "./bind.js";
export { lightmapPlace } from "./inputs.js";
export { limitsOf } from "./limits.js";

/**
 * A plugin for GLTFLoader: `new GLTFLoader().register(irradia())`. The scene that comes is lit; its light is at
 * `gltf.userData.irradia`.
 */
export function irradia(options: IrradiaOptions = {}): IrradiaPlugin {
  return pluginOf(options, () => new WebGPUPainter(options.limits ?? COMMON_BLOCK_LIMITS));
}
