/** How bright, and by which curve. */
import { TONES, type ViewerState } from "../../state/state.js";
import type { Status } from "../../state/status.js";
import type { Store } from "../../state/store.js";
import { stops } from "../../view/exposure.js";
import { section, segments, select, slider } from "../controls.js";
import { choicesFrom, TONE_LABELS } from "./labels.js";

const MODES = [
  { value: "file", label: "File", hint: "What the file says; of the picture where it says nothing" },
  { value: "auto", label: "Auto", hint: "The picture's mean becomes middle grey" },
  { value: "fixed", label: "Fixed", hint: "As the slider stands" },
] as const;

export function exposureSection(state: Store<ViewerState>, status: Store<Status>): HTMLElement {
  const mode = segments("Exposure", MODES, (value) =>
    state.set({ ev: value === "fixed" ? status.value.ev : value }),
  );
  const range = { min: -12, max: 12, step: 0.1, format: stops, rest: 0 };
  const ev = slider("Stops", range, (value) => state.set({ ev: value }));
  const tone = select("Tone curve", choicesFrom(TONES, TONE_LABELS), (value) => state.set({ tone: value }));
  state.watch(
    ({ ev: value }) => value,
    (value) => {
      mode.show(typeof value === "number" ? "fixed" : value);
      if (typeof value === "number") ev.show(value);
    },
  );
  status.watch(({ ev: value }) => value, ev.show);
  state.watch(({ tone: value }) => value, tone.show);
  return section("Exposure", mode.element, ev.element, tone.element);
}
