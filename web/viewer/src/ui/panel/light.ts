/** Which light is shown, and against what. */
import { COMPARISONS, SURFACES, VIEWS, type ViewerState } from "../../state/state.js";
import type { Status } from "../../state/status.js";
import type { Store } from "../../state/store.js";
import type { Difference } from "../../view/difference.js";
import { type Choice, note, section, segments, select, slider } from "../controls.js";
import {
  COMPARISON_LABELS,
  choicesFrom,
  SURFACES_HINTS,
  SURFACES_LABELS,
  VIEW_HINTS,
  VIEW_LABELS,
} from "./labels.js";

type States = Store<ViewerState>;
type Statuses = Store<Status>;

export function lightSection(state: States, status: Statuses): HTMLElement {
  return section(
    "Light",
    ...sideControls(state, status),
    numbersLine(status),
    ...viewControls(state, status),
    surfacesControl(state, status),
    directLine(status),
  );
}

function sideControls(state: States, status: Statuses): HTMLElement[] {
  const left = select<string>("Source", [], (id) => state.set({ left: id }));
  const right = select<string>("Against", [], (id) => state.set({ right: id }));
  const comparisons = choicesFrom(COMPARISONS, COMPARISON_LABELS);
  const compare = segments("Compare", comparisons, (value) => state.set({ compare: value }));
  const gain = gainSlider(state);
  state.watch(
    ({ compare: value }) => value,
    (value) => {
      compare.show(value);
      right.element.hidden = value === "single";
      gain.hidden = value !== "difference";
    },
  );
  status.watch(
    ({ choices }) => choices,
    (choices) => {
      const menu = choices.map(({ id, label }): Choice<string> => ({ value: id, label }));
      left.setChoices(menu);
      right.setChoices(menu);
    },
  );
  status.subscribe((now) => {
    left.show(now.left?.id ?? "");
    right.show(now.right?.id ?? "");
  });
  return [left.element, compare.element, right.element, gain];
}

/** In powers of two. */
function gainSlider(state: States): HTMLElement {
  const options = { min: 0, max: 6, step: 1, format: (power: number) => `× ${2 ** power}`, rest: 3 };
  const gain = slider("Gain", options, (power) => state.set({ gain: 2 ** power }));
  state.watch(
    ({ gain: value }) => Math.log2(value),
    (power) => gain.show(power),
  );
  return gain.element;
}

function numbersLine(status: Statuses): HTMLElement {
  const numbers = note("numbers");
  status.watch(
    ({ difference }) => difference,
    (difference) => numbers.show(difference === undefined ? "" : differenceText(difference)),
  );
  return numbers.element;
}

function differenceText(difference: Difference | null): string {
  if (!difference) return "No pixel in common";
  const { flip, psnrDb } = difference;
  const psnr = Number.isFinite(psnrDb) ? `${psnrDb.toFixed(1)} dB` : "∞";
  return `PSNR ${psnr}   FLIP ${flip.toFixed(4)}`;
}

function viewControls(state: States, status: Statuses): HTMLElement[] {
  const view = select("Show", choicesFrom(VIEWS, VIEW_LABELS), (value) => state.set({ view: value }));
  const hint = note();
  const update = (): void => {
    const { views } = status.value;
    const isMissing = status.value.model !== undefined && !views.includes(state.value.view);
    hint.show(isMissing ? "Magenta: this source has no such view." : (VIEW_HINTS[state.value.view] ?? ""));
    view.show(state.value.view);
  };
  status.watch(
    ({ views }) => views.join(),
    () => {
      const has = (value: (typeof VIEWS)[number]): boolean => status.value.views.includes(value);
      view.setChoices(VIEWS.map((value) => ({ value, label: VIEW_LABELS[value], isDisabled: !has(value) })));
      update();
    },
  );
  state.watch(({ view: value }) => value, update);
  return [view.element, hint.element];
}

/** Where nothing was baked there is nothing to choose. */
function surfacesControl(state: States, status: Statuses): HTMLElement {
  const choices = choicesFrom(SURFACES, SURFACES_LABELS).map((choice) => ({
    ...choice,
    hint: SURFACES_HINTS[choice.value],
  }));
  const surfaces = segments("Surfaces", choices, (value) => state.set({ surfaces: value }));
  state.watch(({ surfaces: value }) => value, surfaces.show);
  status.watch(
    ({ choices: sides }) => sides.filter(({ kind }) => kind === "light").length,
    (nLights) => {
      surfaces.element.hidden = nLights < 2;
    },
  );
  return surfaces.element;
}

function directLine(status: Statuses): HTMLElement {
  const direct = note();
  status.watch(({ direct: text }) => text, direct.show);
  return direct.element;
}
