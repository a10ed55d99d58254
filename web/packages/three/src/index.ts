/** Irradia's baked light in three.js' WebGLRenderer; `@irradia/three/webgpu` is the same for WebGPURenderer. */
export type { LightShader } from "@irradia/runtime";
