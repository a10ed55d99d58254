/** What the page of pixels is asked, and what it answers. */
import type { View } from "../view.js";

/** `webgl` is WebGLRenderer; the others are WebGPURenderer on either of its backends. */
export type Backend = "webgl" | "webgpu" | "webgl2";

/** What a pixel shows in place of its colour; the first two are pictures with light that is known. */
export type Channel = "unlit" | "white" | "position" | "normal" | "surfaceNormal" | "tangent" | "lightmapUv";

export interface Request {
  backend: Backend;
  /** Path of a .glb. */
  scene: string;
  view: View;
  channels: Channel[];
  /** Paths of files with fields, by the names that their sources get. */
  fields: Record<string, string>;
  /** Pictures by name. */
  pictures: Record<string, Picture>;
}

export interface Picture {
  /** Name of a source of light. */
  source: string;
  /** Evaluated by materials, or by a pass over the screen at full or half resolution. */
  how: "inline" | "full" | "half";
  /** As materials by default; only as baked are see-through surfaces drawn. */
  surfacesAs?: "materials" | "baked";
}

/** Pictures are RGBA in floats, linear, rows from the top; in base64, since JSON of floats is slow. */
export interface Answer {
  /** As the renderer says it of itself. */
  backend: Backend;
  pictures: Record<string, string>;
  /** By the number that `lightmapUv` has in its blue, less one: node and primitive of the file. */
  objects: { node: number; primitive: number }[];
}
