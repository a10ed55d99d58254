/** What the viewer shows, as plain data: the store holds it, the URL repeats it, tests compare it. */
import type { Pose } from "../camera/pose.js";

export const COMPARISONS = ["single", "split", "difference", "error"] as const;
/** One picture, two at a slider, their difference, or FLIP's error. */
export type Comparison = (typeof COMPARISONS)[number];

export const VIEWS = [
  "light",
  "irradiance",
  "albedo",
  "normal",
  "depth",
  "raw",
  "hidden",
  "unclamped",
  "position",
  "uv",
  "validity",
] as const;
/** The picture, or a part of how it comes about. */
export type View = (typeof VIEWS)[number];

export const SURFACES = ["baked", "materials"] as const;
/** Each surface scatters all it reflects, as in the reference, or is what its material says, with highlights. */
export type Surfaces = (typeof SURFACES)[number];

export const TONES = ["neutral", "aces", "agx", "linear"] as const;
export type Tone = (typeof TONES)[number];

export const NAVIGATIONS = ["orbit", "fly", "walk"] as const;
export type Navigation = (typeof NAVIGATIONS)[number];

export const PROBE_VIEWS = ["off", "irradiance", "direction", "dc", "validity"] as const;
export type ProbeView = (typeof PROBE_VIEWS)[number];

export const OBJECTS = ["off", "sphere", "knot", "card"] as const;
/** What can be moved through the light. */
export type ObjectShape = (typeof OBJECTS)[number];

export const PASSES = ["inline", "full", "half"] as const;
/** Light in each material, or in a pass over the whole screen. */
export type Pass = (typeof PASSES)[number];

export const BACKENDS = ["auto", "webgpu", "webgl2"] as const;
export type Backend = (typeof BACKENDS)[number];

/** Metres, world space. */
export type Place = readonly [number, number, number];

export interface ViewerState {
  /** Number of the manifest's scene, or a URL; empty for its first. */
  readonly scene: string;
  /** URL of one more field. */
  readonly field: string;
  /** URL of an environment picture. */
  readonly environment: string;
  /** Sources of light by id, such as `lightmap`, `field:0`, `reference`; empty for the best there is. */
  readonly left: string;
  readonly right: string;
  readonly compare: Comparison;
  /** Where the slider stands, 0 the left edge. */
  readonly split: number;
  /** Differences are multiplied by it. */
  readonly gain: number;
  readonly view: View;
  readonly surfaces: Surfaces;
  /** Stops; `auto` from the picture, `file` from what the file says. */
  readonly ev: number | "auto" | "file";
  readonly tone: Tone;
  /** undefined until someone looks elsewhere than the scene's own camera. */
  readonly camera: Pose | undefined;
  readonly navigation: Navigation;
  readonly probes: ProbeView;
  readonly object: ObjectShape;
  /** Where the object stands; undefined for in front of the camera. */
  readonly place: Place | undefined;
  readonly pass: Pass;
  readonly panel: boolean;
}

export const DEFAULTS: ViewerState = {
  scene: "",
  field: "",
  environment: "",
  left: "",
  right: "",
  compare: "single",
  split: 0.5,
  gain: 8,
  view: "light",
  surfaces: "baked",
  ev: "file",
  tone: "neutral",
  camera: undefined,
  navigation: "orbit",
  probes: "off",
  object: "off",
  place: undefined,
  pass: "inline",
  panel: true,
};

/** What the page is told once and doesn't change while it is open. */
export interface PageOptions {
  /** No panels, no animation: pictures for scripts. */
  readonly kiosk: boolean;
  readonly backend: Backend;
  /** The manifest's picture from whose camera to look; undefined for the scene's own. */
  readonly pose: number | undefined;
}
