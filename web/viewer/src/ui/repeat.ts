/** Repeats the state in the URL, and both for scripts on `<html>`. */
import type { ViewerState } from "../state/state.js";
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";
import { readState, writeState } from "../state/url.js";

/** Browsers refuse more than a few changes of the address a second. */
const QUIET_MS = 150;

/** @param base what the address says before `#` */
export function repeatInUrl(state: Store<ViewerState>, status: Store<Status>, base: ViewerState): void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const write = (): void => {
    const hash = `#${writeState(state.value, base)}`;
    if (hash !== location.hash)
      history.replaceState(null, "", hash === "#" ? location.pathname + location.search : hash);
  };
  state.subscribe(() => {
    clearTimeout(timer);
    timer = setTimeout(write, QUIET_MS);
  });
  window.addEventListener("hashchange", () => state.set(readState("", location.hash, base)));
  status.subscribe(tell);
  tell(status.value);
}

function tell({ phase, message, ev, backend, left, right }: Status): void {
  const wanted = { state: phase, message, ev: ev.toFixed(3), backend, source: left?.id, right: right?.id };
  for (const [key, value] of Object.entries(wanted)) {
    if (value === undefined || value === "") delete document.documentElement.dataset[key];
    else document.documentElement.dataset[key] = value;
  }
}
