/** All that is on the page, and what its buttons do. */
import type { App } from "../app.js";
import { acceptDrops, pickFiles, type ReadFiles } from "../files/drop.js";
import type { ViewerState } from "../state/state.js";
import { writeState } from "../state/url.js";
import { bar } from "./bar.js";
import { el } from "./dom.js";
import { helpDialog } from "./help.js";
import { listenToKeys } from "./keys.js";
import { panel } from "./panel/index.js";
import { poseHint } from "./pose-hint.js";
import { problems } from "./problems.js";
import { splitter } from "./splitter.js";
import { welcome } from "./welcome.js";

/** How long a browser may take to begin with a download. */
const DOWNLOAD_MS = 60_000;

/** @param base what the address says before `#` */
export function buildPage(app: App, base: ViewerState): void {
  const { state, status, options, host } = app;
  const help = helpDialog();
  const toast = el("div", { class: "toast", role: "status" });
  const openFiles = (): void => pickFiles((read) => openAll(app, read));
  const actions = {
    openFiles,
    openScene: (index: number) => state.set({ scene: String(index), camera: undefined, place: undefined }),
    savePicture: () => tell(toast, savePicture(app), "Picture saved", "There is no picture to save"),
    copyLink: () => tell(toast, copyLink(app, base), "Link copied", "The address is the link"),
    fullScreen: () => tell(toast, toggleFullScreen(), "", "The browser refuses to fill the screen"),
    help: () => (help.open ? help.close() : help.showModal()),
    togglePanel: () => state.set({ panel: !state.value.panel }),
    home: () => app.home(),
    lookFrom: (index: number) => app.lookFromNumber(index),
    frameAll: () => app.frameAll(),
  };
  const hint = options.kiosk ? undefined : poseHint(status, () => app.lookFromShown());
  const stage = el("main", { class: "stage" }, host, splitter(state, status), hint);
  const page = options.kiosk
    ? [stage]
    : [bar(status, actions), stage, panel(state, status, actions), welcome(status, openFiles), help, toast];
  document.body.append(...page, problems(status, host));
  document.body.classList.toggle("kiosk", options.kiosk);
  state.watch(
    ({ panel: isOpen }) => isOpen,
    (isOpen) => document.body.classList.toggle("with-panel", isOpen),
  );
  acceptDrops(document.body, (read) => openAll(app, read));
  if (!options.kiosk) listenToKeys(state, status, actions);
}

function openAll({ session }: App, read: ReadFiles): void {
  void session.open(read);
}

async function savePicture(app: App): Promise<void> {
  const url = URL.createObjectURL(await app.picture());
  const name = (app.status.value.model?.name ?? "irradia").replace(/\.\w+$/, "");
  el("a", { href: url, download: `${name}.png` }).click();
  setTimeout(() => URL.revokeObjectURL(url), DOWNLOAD_MS);
}

async function copyLink({ state }: App, base: ViewerState): Promise<void> {
  await navigator.clipboard.writeText(`${location.href.split("#")[0]}#${writeState(state.value, base)}`);
}

async function toggleFullScreen(): Promise<void> {
  if (document.fullscreenElement) await document.exitFullscreen();
  else await document.documentElement.requestFullscreen();
}

/** Says what became of something. */
function tell(toast: HTMLElement, work: Promise<void>, done: string, failed: string): void {
  work.then(
    () => done && say(toast, done),
    () => say(toast, failed),
  );
}

function say(toast: HTMLElement, text: string): void {
  toast.textContent = text;
  toast.classList.add("shown");
  setTimeout(() => toast.classList.remove("shown"), 1800);
}
