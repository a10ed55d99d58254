/** Keys of the whole page. */
import { isForControl } from "../camera/look.js";
import {
  COMPARISONS,
  DEFAULTS,
  NAVIGATIONS,
  OBJECTS,
  PROBE_VIEWS,
  VIEWS,
  type ViewerState,
} from "../state/state.js";
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";

/** Half a stop. */
const EV_STEP = 0.5;

export interface KeyActions {
  readonly home: () => void;
  readonly savePicture: () => void;
  readonly copyLink: () => void;
  readonly fullScreen: () => void;
  readonly help: () => void;
}

export function listenToKeys(state: Store<ViewerState>, status: Store<Status>, actions: KeyActions): void {
  const bindings = bindingsOf(state, status, actions);
  window.addEventListener("keydown", (event) => {
    if (isForControl(event)) return;
    const does = bindings[event.key] ?? bindings[event.key.toLowerCase()];
    if (!does) return;
    event.preventDefault();
    does();
  });
}

function bindingsOf(
  state: Store<ViewerState>,
  status: Store<Status>,
  actions: KeyActions,
): Readonly<Record<string, () => void>> {
  const brighter = (stops: number): void => state.set({ ev: Math.round(2 * (status.value.ev + stops)) / 2 });
  const source = (step: number): void => {
    const ids = status.value.choices.map(({ id }) => id);
    state.set({ left: after(ids, status.value.left?.id ?? "", step) });
  };
  return {
    "1": () => state.set({ navigation: NAVIGATIONS[0] }),
    "2": () => state.set({ navigation: NAVIGATIONS[1] }),
    "3": () => state.set({ navigation: NAVIGATIONS[2] }),
    "0": () => state.set({ ev: DEFAULTS.ev }),
    "-": () => brighter(-EV_STEP),
    "+": () => brighter(EV_STEP),
    "=": () => brighter(EV_STEP),
    "[": () => source(-1),
    "]": () => source(1),
    c: () => state.set({ compare: after(COMPARISONS, state.value.compare) }),
    x: () => state.set({ left: status.value.right?.id ?? "", right: status.value.left?.id ?? "" }),
    v: () => {
      const possible = VIEWS.filter((view) => status.value.views.includes(view));
      state.set({ view: after(possible, state.value.view) });
    },
    o: () => state.set({ object: after(OBJECTS, state.value.object) }),
    b: () => state.set({ probes: after(PROBE_VIEWS, state.value.probes) }),
    h: actions.home,
    p: actions.savePicture,
    l: actions.copyLink,
    f: actions.fullScreen,
    "?": actions.help,
    n: () => state.set({ panel: !state.value.panel }),
  };
}

/** The next of some values, round and round. */
export function after<T>(values: readonly T[], value: T, step = 1): T {
  const next = (values.indexOf(value) + step + values.length) % values.length;
  return values[next] ?? value;
}
