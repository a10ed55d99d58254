/** The panel at the right: what lights the scene, how it is shown, where from. */
import type { ViewerState } from "../../state/state.js";
import type { Status } from "../../state/status.js";
import type { Store } from "../../state/store.js";
import { el } from "../dom.js";
import { exposureSection } from "./exposure.js";
import { frameSection } from "./frame.js";
import { lightSection } from "./light.js";
import { type CameraActions, cameraSection, objectSection } from "./scene.js";

export function panel(state: Store<ViewerState>, status: Store<Status>, actions: CameraActions): HTMLElement {
  return el(
    "aside",
    { class: "panel", "aria-label": "Settings" },
    lightSection(state, status),
    exposureSection(state, status),
    cameraSection(state, status, actions),
    objectSection(state, status),
    frameSection(state, status),
  );
}
