/** How often light is evaluated, and what a frame costs. */
import { PASSES, type ViewerState } from "../../state/state.js";
import type { Status } from "../../state/status.js";
import type { Store } from "../../state/store.js";
import { section, segments } from "../controls.js";
import { el } from "../dom.js";
import { choicesFrom, PASS_LABELS } from "./labels.js";

const HINTS = {
  inline: "In each material, for whatever it covers",
  full: "Once a pixel, whatever is drawn over what; fields and probes",
  half: "For every second pixel of every second row; fields and probes",
} as const;

export function frameSection(state: Store<ViewerState>, status: Store<Status>): HTMLElement {
  const choices = choicesFrom(PASSES, PASS_LABELS).map((choice) => ({
    ...choice,
    hint: HINTS[choice.value],
  }));
  const pass = segments("Light per", choices, (value) => state.set({ pass: value }));
  const table = el("dl", { class: "statistics" });
  state.watch(({ pass: value }) => value, pass.show);
  status.watch(
    ({ statistics }) => statistics,
    (statistics) => {
      const rows = statistics.flatMap(({ label, value, hint }) => [
        el("dt", { title: hint }, label),
        el("dd", {}, value),
      ]);
      table.replaceChildren(...rows);
    },
  );
  return section("Frame", pass.element, table);
}
