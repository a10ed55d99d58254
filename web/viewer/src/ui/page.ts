/** All that is on the page, and what its buttons do. */
import type { App } from "../app.js";
import { acceptDrops, pickFiles, readFiles } from "../files/drop.js";
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

export function buildPage(app: App): void {
  const { state, status, options, host } = app;
  const help = helpDialog();
  const toast = el("div", { class: "toast", role: "status" });
  const openFiles = (): void => pickFiles((files) => void openAll(app, files));
  const actions = {
    openFiles,
    openScene: (index: number) => state.set({ scene: String(index), camera: undefined }),
    savePicture: () => void savePicture(app).then(() => say(toast, "Picture saved")),
    copyLink: () =>
      void copyLink(app).then((done) => say(toast, done ? "Link copied" : "The address is the link")),
    fullScreen: () => void toggleFullScreen(),
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
  document.body.append(...page, problems(status));
  document.body.classList.toggle("kiosk", options.kiosk);
  state.watch(
    ({ panel: isOpen }) => isOpen,
    (isOpen) => document.body.classList.toggle("with-panel", isOpen),
  );
  acceptDrops(document.body, (files) => void openAll(app, files));
  if (!options.kiosk) listenToKeys(state, status, actions);
}

async function openAll(app: App, files: readonly File[]): Promise<void> {
  app.status.set({ problems: [] });
  await app.session.open(await readFiles(files));
  await app.settled();
}

async function savePicture(app: App): Promise<void> {
  const url = URL.createObjectURL(await app.picture());
  const name = (app.status.value.model?.name ?? "irradia").replace(/\.\w+$/, "");
  el("a", { href: url, download: `${name}.png` }).click();
  URL.revokeObjectURL(url);
}

async function copyLink({ state }: App): Promise<boolean> {
  const url = `${location.href.split("#")[0]}#${writeState(state.value)}`;
  try {
    await navigator.clipboard.writeText(url);
    return true;
  } catch {
    return false;
  }
}

async function toggleFullScreen(): Promise<void> {
  if (document.fullscreenElement) await document.exitFullscreen();
  else await document.documentElement.requestFullscreen();
}

function say(toast: HTMLElement, text: string): void {
  toast.textContent = text;
  toast.classList.add("shown");
  setTimeout(() => toast.classList.remove("shown"), 1800);
}
