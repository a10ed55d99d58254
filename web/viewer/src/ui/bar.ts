/** The bar at the top: what is open, and what can be done with it. */
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";
import { el, icon, iconButton } from "./dom.js";

export interface BarActions {
  readonly openScene: (index: number) => void;
  readonly openFiles: () => void;
  readonly savePicture: () => void;
  readonly copyLink: () => void;
  readonly fullScreen: () => void;
  readonly help: () => void;
  readonly togglePanel: () => void;
}

export function bar(status: Store<Status>, actions: BarActions): HTMLElement {
  const name = el("span", { class: "file" });
  const progress = el("progress", { hidden: true, max: 1, "aria-label": "Reading files" });
  status.watch(
    ({ model }) => model?.name ?? "",
    (text) => {
      name.textContent = text;
      document.title = text ? `${text} · Irradia` : "Irradia";
    },
  );
  status.subscribe(({ phase, progress: share }) => {
    progress.hidden = phase !== "loading";
    if (share === undefined) progress.removeAttribute("value");
    else progress.value = share;
  });
  return el(
    "header",
    { class: "bar" },
    el("span", { class: "brand" }, "Irradia"),
    name,
    sceneMenu(status, actions.openScene),
    progress,
    el("span", { class: "space" }),
    el(
      "button",
      { class: "open", type: "button", click: actions.openFiles },
      icon("open"),
      el("span", {}, "Open"),
    ),
    iconButton("camera", "Save a picture (P)", actions.savePicture),
    iconButton("link", "Copy a link to this view (L)", actions.copyLink),
    iconButton("full", "Full screen (F)", actions.fullScreen),
    iconButton("help", "Keys (?)", actions.help),
    iconButton("panel", "Settings (N)", actions.togglePanel),
  );
}

/** Of a manifest with several scenes. */
function sceneMenu(status: Store<Status>, openScene: (index: number) => void): HTMLElement {
  const menu = el("select", { class: "scenes", "aria-label": "Scene", hidden: true });
  menu.addEventListener("change", () => openScene(menu.selectedIndex));
  status.watch(
    ({ scenes }) => scenes,
    (scenes) => {
      menu.replaceChildren(...scenes.map((scene) => el("option", {}, scene)));
      menu.hidden = scenes.length < 2;
    },
  );
  return menu;
}
