/** The panel at the right: what lights the scene, how it is shown, where from. */
import {
  COMPARISONS,
  type Comparison,
  NAVIGATIONS,
  type Navigation,
  OBJECTS,
  PASSES,
  PROBE_VIEWS,
  TONES,
  VIEWS,
  type View,
  type ViewerState,
} from "../state/state.js";
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";
import { stops } from "../view/exposure.js";
import { type Choice, note, section, segments, select, slider } from "./controls.js";
import { el } from "./dom.js";

/** What the panel can ask for beside changes of state. */
export interface PanelActions {
  readonly lookFrom: (index: number) => void;
  readonly frameAll: () => void;
}

const COMPARISON_LABELS: Record<Comparison, string> = {
  single: "One",
  split: "Split",
  difference: "Differ",
  error: "FLIP",
};
const VIEW_LABELS: Record<View, string> = {
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
  validity: "Valid texels",
};
const PROBE_LABELS = {
  off: "Hidden",
  irradiance: "Irradiance",
  direction: "Dominant direction",
  dc: "Mean alone",
  validity: "Validity",
} as const;
const OBJECT_LABELS = { off: "None", sphere: "Sphere", knot: "Knot", card: "Card" } as const;
const TONE_LABELS = { neutral: "Neutral", aces: "ACES", agx: "AgX", linear: "Linear" } as const;
const NAVIGATION_LABELS: Record<Navigation, string> = { orbit: "Orbit", fly: "Fly", walk: "Walk" };
const PASS_LABELS = { inline: "In materials", full: "Full", half: "Half" } as const;

type States = Store<ViewerState>;
type Statuses = Store<Status>;

export function panel(state: States, status: Statuses, actions: PanelActions): HTMLElement {
  return el(
    "aside",
    { class: "panel", "aria-label": "Settings" },
    lightSection(state, status),
    exposureSection(state, status),
    cameraSection(state, status, actions),
    objectSection(state),
    frameSection(state, status),
  );
}

function lightSection(state: States, status: Statuses): HTMLElement {
  const compare = segments("Compare", choicesFrom(COMPARISONS, COMPARISON_LABELS), (value) =>
    state.set({ compare: value }),
  );
  const left = select<string>("Source", [], (id) => state.set({ left: id }));
  const right = select<string>("Against", [], (id) => state.set({ right: id }));
  const gain = slider("Gain", { min: 0, max: 6, step: 0.5, format: (x) => `× ${2 ** x}`, rest: 3 }, (x) =>
    state.set({ gain: 2 ** x }),
  );
  const view = select("Show", choicesFrom(VIEWS, VIEW_LABELS), (value) => state.set({ view: value }));
  const numbers = note("numbers");
  const direct = note();
  state.watch(
    ({ compare: value }) => value,
    (value) => {
      compare.show(value);
      right.element.hidden = value === "single";
      gain.element.hidden = value !== "difference";
    },
  );
  state.watch(
    ({ gain: value }) => value,
    (value) => gain.show(Math.log2(value)),
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
  status.watch(
    ({ views }) => views,
    (views) =>
      view.setChoices(
        VIEWS.map((value) => ({ value, label: VIEW_LABELS[value], isDisabled: !views.includes(value) })),
      ),
  );
  state.watch(({ view: value }) => value, view.show);
  status.watch(
    ({ difference }) => difference,
    (difference) => numbers.show(difference ? differenceText(difference) : ""),
  );
  status.watch(({ direct: text }) => text, direct.show);
  return section(
    "Light",
    left.element,
    compare.element,
    right.element,
    gain.element,
    numbers.element,
    view.element,
    direct.element,
  );
}

function differenceText({ flip, psnrDb }: NonNullable<Status["difference"]>): string {
  const psnr = Number.isFinite(psnrDb) ? `${psnrDb.toFixed(1)} dB` : "∞";
  return `PSNR ${psnr}   FLIP ${flip.toFixed(4)}`;
}

function exposureSection(state: States, status: Statuses): HTMLElement {
  const choices = [
    { value: "file", label: "File", hint: "What the file says; of the picture where it says nothing" },
    { value: "auto", label: "Auto", hint: "The picture's mean becomes middle grey" },
    { value: "manual", label: "Fixed", hint: "As the slider stands" },
  ] as const;
  const mode = segments("Exposure", choices, (value) =>
    state.set({ ev: value === "manual" ? status.value.ev : value }),
  );
  const ev = slider("Stops", { min: -12, max: 12, step: 0.1, format: stops, rest: 0 }, (value) =>
    state.set({ ev: value }),
  );
  const tone = select("Tone curve", choicesFrom(TONES, TONE_LABELS), (value) => state.set({ tone: value }));
  state.watch(
    ({ ev: value }) => value,
    (value) => mode.show(typeof value === "number" ? "manual" : value),
  );
  status.watch(({ ev: value }) => value, ev.show);
  state.watch(({ tone: value }) => value, tone.show);
  return section("Exposure", mode.element, ev.element, tone.element);
}

function cameraSection(state: States, status: Statuses, actions: PanelActions): HTMLElement {
  const navigation = segments("Move", choicesFrom(NAVIGATIONS, NAVIGATION_LABELS), (value) =>
    state.set({ navigation: value }),
  );
  const places = select<string>("Look from", [], (value) => {
    if (value === "all") actions.frameAll();
    else actions.lookFrom(Number(value));
    places.show("");
  });
  state.watch(({ navigation: value }) => value, navigation.show);
  const names = ({ model, references }: Status): string =>
    JSON.stringify([
      model?.cameras.map(({ name }) => name),
      references.map(({ label, pose }) => pose && label),
    ]);
  status.watch(names, () => places.setChoices([{ value: "", label: "…" }, ...viewpoints(status.value)]));
  return section("Camera", navigation.element, places.element);
}

/** Cameras of the file, then those of pictures, then all of it; numbered as `lookFrom` counts. */
function viewpoints({ model, references }: Status): Choice<string>[] {
  const cameras = model?.cameras.map(({ name }) => name) ?? [];
  const pictures = references.filter(({ pose }) => pose).map(({ label }) => label);
  const named = [...cameras, ...pictures].map((label, index) => ({ value: String(index), label }));
  return [...named, { value: "all", label: "All of it" }];
}

function objectSection(state: States): HTMLElement {
  const object = segments("Object", choicesFrom(OBJECTS, OBJECT_LABELS), (value) =>
    state.set({ object: value }),
  );
  const hint = note();
  const probes = select("Probes", choicesFrom(PROBE_VIEWS, PROBE_LABELS), (value) =>
    state.set({ probes: value }),
  );
  state.watch(
    ({ object: value }) => value,
    (value) => {
      object.show(value);
      hint.show(value === "off" ? "" : "Drag it to feel the light; with Shift up and down.");
    },
  );
  state.watch(({ probes: value }) => value, probes.show);
  return section("In the light", object.element, hint.element, probes.element);
}

function frameSection(state: States, status: Statuses): HTMLElement {
  const pass = segments("Light per", choicesFrom(PASSES, PASS_LABELS), (value) => state.set({ pass: value }));
  const table = el("dl", { class: "statistics" });
  state.watch(({ pass: value }) => value, pass.show);
  status.watch(
    ({ statistics }) => statistics,
    (statistics) =>
      table.replaceChildren(
        ...statistics.flatMap(({ label, value, hint }) => [
          el("dt", { title: hint }, label),
          el("dd", {}, value),
        ]),
      ),
  );
  return section("Frame", pass.element, table);
}

function choicesFrom<T extends string>(values: readonly T[], labels: Record<T, string>): Choice<T>[] {
  return values.map((value) => ({ value, label: labels[value] }));
}
