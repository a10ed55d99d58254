/** Says that a picture was taken from elsewhere, and goes there. */
import type { Status } from "../state/status.js";
import type { Store } from "../state/store.js";
import { el } from "./dom.js";

export function poseHint(status: Store<Status>, goThere: () => void): HTMLElement {
  const button = el("button", { type: "button", click: goThere }, "Go there");
  const element = el("div", { class: "hint", hidden: true }, "The render was taken from elsewhere", button);
  status.watch(
    ({ isOffPose }) => isOffPose,
    (isOffPose) => {
      element.hidden = !isOffPose;
    },
  );
  return element;
}
