/** Irradia's baked light in three.js' WebGLRenderer; `@irradia/three/webgpu` is the same for WebGPURenderer. */
import { COMMON_LIMITS } from "./core/limits.js";
import { pluginOf } from "./core/plugin.js";
import type { IrradiaOptions, IrradiaPlugin } from "./types.js";
import { WebGLPainter } from "./webgl/painter.js";

export { readyUnzstd } from "./core/unzstd.js";
export { IrradiancePass, type IrradiancePassOptions } from "./pass/webgl-pass.js";
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
} from "./types.js";
export { LIGHTMAP_ATTRIBUTES } from "./types.js";
export { type BoundShader, bindGlsl, callOf } from "./webgl/bind.js";
export { limitsOf } from "./webgl/limits.js";

/**
 * A plugin for GLTFLoader: `new GLTFLoader().register(irradia())`. The scene that comes is lit; its light is at
 * `gltf.userData.irradia`.
 */
export function irradia(options: IrradiaOptions = {}): IrradiaPlugin {
  return pluginOf(options, () => new WebGLPainter(options.limits ?? COMMON_LIMITS));
}
