/** What the page of the plugin is asked, and what it answers. */
import type { Backend } from "../pixels/request.js";
import type { View } from "../view.js";

/** Done in this order before a picture is drawn; what is absent stays as it was. */
export interface Step {
  /** Paints all materials black. */
  black?: true;
  /** Gives all materials a constant occlusion map. */
  occlusion?: number;
  /** Surrounds the scene with even light of this radiance; 0 is none. */
  surroundings?: number;
  /** `light.use`. */
  use?: string;
  view?: string | null;
  intensity?: number;
  dynamicSource?: string | null;
  surfacesAs?: "materials" | "baked";
  /** Puts a white ball there, lit or not. */
  ball?: { centre: [number, number, number]; radius: number; isLit: boolean };
  /** `light.dispose`. */
  dispose?: true;
}

export interface Job {
  backend: Backend;
  /** Where the .glb is served. */
  scene: string;
  view: View;
  /** `stock` loads with the MOZ_lightmap plugin in ours' place, `both` with both. */
  plugins: "irradia" | "stock" | "both";
  steps: Step[];
}

export interface Shot {
  /** RGBA in floats, linear, rows from the top; in base64. */
  picture: string;
  source: string;
  directFrom: string;
  /** Of lights in the file's order. */
  shining: boolean[];
  bytes: number;
  /** Programs or shader modules that the page has compiled so far. */
  nCompiled: number;
  /** Copies of materials that meshes have worn so far. */
  nMaterials: number;
}

export interface Report {
  backend: Backend;
  /** What the loader threw, in place of all that follows. */
  refusal?: string;
  sources: { name: string; kind: string; quantity: string; isDynamic: boolean }[];
  shots: Shot[];
}
