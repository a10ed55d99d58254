/** What the panel calls the values of the state. */
import type {
  Comparison,
  Navigation,
  ObjectShape,
  Pass,
  ProbeView,
  Surfaces,
  Tone,
  View,
} from "../../state/state.js";
import type { Choice } from "../controls.js";

export const COMPARISON_LABELS: Record<Comparison, string> = {
  single: "One",
  split: "Split",
  difference: "Diff",
  error: "FLIP",
};
export const VIEW_LABELS: Record<View, string> = {
  light: "Picture",
  irradiance: "Irradiance alone",
  albedo: "Albedo",
  normal: "Normal",
  depth: "Depth",
  raw: "Raw output of the network",
  hidden: "Hidden activations",
  unclamped: "Output without clamp",
  position: "Normalised position",
  uv: "Lightmap UV checker",
  validity: "Validity",
};
/** What a view's colours mean, where they don't say it themselves. */
export const VIEW_HINTS: Partial<Record<View, string>> = {
  raw: "Numbers of either sign: grey is 0.",
  uv: "A square is 4 × 4 texels.",
  validity:
    "Green: texels that see all around them; red: inside something; blue: outside charts. Of probes: white where they are valid.",
};
export const SURFACES_LABELS: Record<Surfaces, string> = { baked: "As baked", materials: "Materials" };
export const SURFACES_HINTS: Record<Surfaces, string> = {
  baked: "Each surface scatters all it reflects, as in the reference",
  materials: "three.js' own, with highlights",
};
export const PROBE_LABELS: Record<ProbeView, string> = {
  off: "Hidden",
  irradiance: "Irradiance",
  direction: "Dominant direction",
  dc: "Mean alone",
  validity: "Validity",
};
export const OBJECT_LABELS: Record<ObjectShape, string> = {
  off: "None",
  sphere: "Sphere",
  knot: "Knot",
  card: "Card",
};
export const TONE_LABELS: Record<Tone, string> = {
  neutral: "Neutral",
  aces: "ACES",
  agx: "AgX",
  linear: "Linear",
};
export const NAVIGATION_LABELS: Record<Navigation, string> = { orbit: "Orbit", fly: "Fly", walk: "Walk" };
export const PASS_LABELS: Record<Pass, string> = { inline: "Material", full: "Pixel", half: "Half" };

export function choicesFrom<T extends string>(values: readonly T[], labels: Record<T, string>): Choice<T>[] {
  return values.map((value) => ({ value, label: labels[value] }));
}
