/** What the page of costs is asked, and what it answers. */
import type { Backend } from "../pixels/request.js";
import type { View } from "../view.js";

/** Evaluated by materials, or by a pass over the screen at full or half resolution. */
export type How = "inline" | "full" | "half";

export interface CostRequest {
  backend: Backend;
  /** Path of a .glb with a lightmap and probes. */
  scene: string;
  view: View;
  /** Paths of files with fields, by the names that their sources get. */
  fields: Record<string, string>;
  /** Sources that passes can evaluate, by name, among the fields and the file's own. */
  screened: string[];
  sources: string[];
  rounds: number;
}

export interface Timing {
  source: string;
  how: How;
  /** Milliseconds of a frame, one of each round. */
  milliseconds: number[];
}

export interface CostAnswer {
  backend: Backend;
  timings: Timing[];
  /** Of one evaluation, by source. */
  costs: Record<string, { flops: number; fetches: number; bytes: number }>;
}
