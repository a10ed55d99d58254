/** What an empty page says, and what it says while something is read. */
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";
import { el } from "./dom.js";

export function welcome(status: Store<Status>, openFiles: () => void): HTMLElement {
  const empty = el(
    "div",
    { class: "invitation" },
    el("h1", {}, "Drop a baked scene"),
    el(
      "p",
      {},
      "A .glb from ",
      el("code", {}, "irradia bake"),
      ", and with it fields, a panorama or a render to compare.",
    ),
    el("button", { class: "primary", type: "button", click: openFiles }, "Open files…"),
    el("p", { class: "fine" }, "Files stay on this machine."),
  );
  const message = el("p", { class: "message" });
  const loading = el("div", { class: "loading" }, el("div", { class: "spinner" }), message);
  const element = el("div", { class: "welcome" }, empty, loading);
  status.watch(
    ({ phase, model, message: text }) => `${phase} ${model ? 1 : 0} ${text}`,
    () => {
      const { phase, model, message: text } = status.value;
      empty.hidden = model !== undefined || phase === "loading";
      loading.hidden = phase !== "loading";
      message.textContent = text;
      element.hidden = empty.hidden && loading.hidden;
    },
  );
  return element;
}
