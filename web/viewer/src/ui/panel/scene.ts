/** From where, what moves, and which probes. */
import { NAVIGATIONS, OBJECTS, PROBE_VIEWS, type ViewerState } from "../../state/state.js";
import type { Status } from "../../state/status.js";
import type { Store } from "../../state/store.js";
import { type Choice, note, section, segments, select } from "../controls.js";
import { choicesFrom, NAVIGATION_LABELS, OBJECT_LABELS, PROBE_LABELS } from "./labels.js";

export interface CameraActions {
  readonly lookFrom: (index: number) => void;
  readonly frameAll: () => void;
}

export function cameraSection(
  state: Store<ViewerState>,
  status: Store<Status>,
  { lookFrom, frameAll }: CameraActions,
): HTMLElement {
  const navigations = choicesFrom(NAVIGATIONS, NAVIGATION_LABELS);
  const navigation = segments("Move", navigations, (value) => state.set({ navigation: value }));
  const places = select<string>("Look from", [], (value) => {
    if (value === "all") frameAll();
    else if (value !== "") lookFrom(Number(value));
    places.show("");
  });
  state.watch(({ navigation: value }) => value, navigation.show);
  status.watch(
    (now) => JSON.stringify(viewpoints(now)),
    () => places.setChoices([{ value: "", label: "…" }, ...viewpoints(status.value)]),
  );
  return section("Camera", navigation.element, places.element);
}

/** Cameras of the file, then those of pictures, then all of it; numbered as `lookFrom` counts. */
function viewpoints({ model, references }: Status): Choice<string>[] {
  const cameras = model?.cameras.map(({ name }) => name) ?? [];
  const pictures = references.filter(({ pose }) => pose).map(({ label }) => label);
  const named = [...cameras, ...pictures].map((label, index) => ({ value: String(index), label }));
  return [...named, { value: "all", label: "All of it" }];
}

export function objectSection(state: Store<ViewerState>, status: Store<Status>): HTMLElement {
  const object = select("Object", choicesFrom(OBJECTS, OBJECT_LABELS), (value) =>
    state.set({ object: value }),
  );
  const hint = note();
  const modes = choicesFrom(PROBE_VIEWS, PROBE_LABELS);
  const probes = select("Probes", modes, (value) => state.set({ probes: value }));
  state.watch(
    ({ object: value }) => value,
    (value) => {
      object.show(value);
      hint.show(value === "off" ? "" : "Drag it through the light; with Shift up and down.");
    },
  );
  state.watch(({ probes: value }) => value, probes.show);
  status.watch(
    ({ model }) => model?.light.baked?.probes !== undefined,
    (hasProbes) => probes.setChoices(modes.map((mode) => ({ ...mode, isDisabled: !hasProbes }))),
  );
  return section("In the light", object.element, hint.element, probes.element);
}
