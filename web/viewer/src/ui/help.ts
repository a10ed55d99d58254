/** The keys, on a page of their own. */
import { el, iconButton } from "./dom.js";

const KEYS: readonly (readonly [title: string, rows: readonly (readonly [keys: string, does: string])[]])[] =
  [
    [
      "Move",
      [
        ["1 2 3", "Orbit, fly, walk"],
        ["Drag", "Turn; look about when flying or walking"],
        ["Right drag, two fingers", "Shift; walk on when flying or walking"],
        ["W A S D", "Forward, left, back, right"],
        ["Q E", "Down, up, when flying"],
        ["Shift", "Four times as fast"],
        ["H", "Back to the start"],
      ],
    ],
    [
      "Compare",
      [
        ["C", "One, split, differ, FLIP"],
        ["X", "Exchange the sides"],
        ["[ ]", "Source before, source after"],
        ["V", "Next view"],
      ],
    ],
    [
      "Picture",
      [
        ["− +", "Darker, brighter by half a stop"],
        ["0", "The file's own exposure"],
        ["O", "Something to move through the light"],
        ["B", "Probes"],
        ["P", "Save a picture"],
        ["L", "Copy a link"],
      ],
    ],
    [
      "Page",
      [
        ["N", "Settings"],
        ["F", "Full screen"],
        ["?", "These keys"],
      ],
    ],
  ];

export function helpDialog(): HTMLDialogElement {
  const dialog = el("dialog", { class: "help", "aria-label": "Keys", autofocus: true });
  dialog.append(
    el(
      "header",
      {},
      el("h2", {}, "Keys"),
      iconButton("close", "Close", () => dialog.close()),
    ),
    el("div", { class: "columns" }, ...KEYS.map(([title, rows]) => group(title, rows))),
    el(
      "p",
      { class: "note" },
      "Drop .glb, fields (.safetensors, .zst, .bin), panoramas and renders anywhere.",
    ),
  );
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
  return dialog;
}

function group(title: string, rows: readonly (readonly [string, string])[]): HTMLElement {
  const lines = rows.flatMap(([keys, does]) => [el("dt", {}, keys), el("dd", {}, does)]);
  return el("section", {}, el("h3", {}, title), el("dl", {}, ...lines));
}
