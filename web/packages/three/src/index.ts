/** Irradia's baked light in three.js' WebGLRenderer; `@irradia/three/webgpu` is the same for WebGPURenderer. */
export type {
  DirectFrom,
  Inputs,
  IrradiaOptions,
  IrradiaPlugin,
  LightSource,
  LitSurface,
  SceneLight,
  SourceKind,
  View,
} from "./types.js";
export { LIGHTMAP_ATTRIBUTES } from "./types.js";
