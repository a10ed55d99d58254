/** The line between both sides, to be dragged, and their names beside it. */
import type { ViewerState } from "../state/state.js";
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";
import { el } from "./dom.js";

const KEY_STEP = 0.02;

export function splitter(state: Store<ViewerState>, status: Store<Status>): HTMLElement {
  const left = el("span", { class: "side left" });
  const right = el("span", { class: "side right" });
  const handle = el("div", {
    class: "handle",
    role: "slider",
    tabindex: 0,
    "aria-label": "Where the sides meet",
    "aria-valuemin": 0,
    "aria-valuemax": 100,
  });
  const element = el("div", { class: "splitter", hidden: true }, handle, left, right);
  const moveTo = (split: number): void => state.set({ split: Math.max(0, Math.min(1, split)) });
  handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
  handle.addEventListener("pointermove", (event) => {
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const { left: from, width } = element.getBoundingClientRect();
    moveTo((event.clientX - from) / width);
  });
  handle.addEventListener("keydown", ({ key }) => {
    const sign = key === "ArrowLeft" ? -1 : key === "ArrowRight" ? 1 : 0;
    if (sign) moveTo(state.value.split + sign * KEY_STEP);
  });
  handle.addEventListener("dblclick", () => moveTo(0.5));
  state.watch(
    ({ split }) => split,
    (split) => {
      element.style.setProperty("--split", `${100 * split}%`);
      handle.setAttribute("aria-valuenow", String(Math.round(100 * split)));
    },
  );
  state.watch(
    ({ compare }) => compare,
    (compare) => {
      element.hidden = compare !== "split";
    },
  );
  status.subscribe((now) => {
    left.textContent = now.left?.label ?? "";
    right.textContent = now.right?.label ?? "";
  });
  return element;
}
