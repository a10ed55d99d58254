/** Starts the page: its address and manifest say what to open. */
import { App } from "./app.js";
import type { Manifest } from "./files/manifest.js";
import { manifestOfPage } from "./files/page-manifest.js";
import { problemOf } from "./files/problem.js";
import { DEFAULTS, type ViewerState } from "./state/state.js";
import { NO_STATUS } from "./state/status.js";
import { Store } from "./state/store.js";
import { readPageOptions, readState } from "./state/url.js";
import { buildPage } from "./ui/page.js";
import { repeatInUrl } from "./ui/repeat.js";

const options = readPageOptions(location.search);
// Kiosks are often drawn without a GPU, where evaluating light once a pixel saves most of the time.
const defaults = options.kiosk ? { ...DEFAULTS, pass: "full" as const } : DEFAULTS;
const base = readState(location.search, "", defaults);
const state = new Store(readState(location.search, location.hash, defaults));
const status = new Store(NO_STATUS);
const host = document.createElement("div");
host.className = "view";
host.tabIndex = -1;
const app = new App(host, state, status, options);
buildPage(app, base);
repeatInUrl(state, status, base);

const ready = start().catch((error: unknown) => {
  const problem = { ...problemOf(error, "the page"), title: "Can't start" };
  status.set({ problems: [problem], phase: "error", message: problem.finding, isOpening: false });
});

/** For scripts that drive the page. */
Object.assign(globalThis, {
  irradiaViewer: { ready, state, status, picture: () => app.picture(), settled: () => app.settled() },
});

async function start(): Promise<void> {
  await app.start();
  const manifest = await manifestOfPage();
  if (manifest) state.set(startOf(manifest.start, state.value));
  state.subscribe((now, before) => follow(manifest, now, before));
  openScene(manifest);
  openBeside(state.value.environment);
  const { pose } = options;
  await app.session.after(() => pose !== undefined && app.lookFromPicture(pose));
  await app.settled();
}

/** Opens what the state names now and didn't before. */
function follow(manifest: Manifest | undefined, now: ViewerState, before: ViewerState): void {
  if (now.scene !== before.scene) openScene(manifest);
  else if (now.field !== before.field) {
    if (before.field !== "") void app.session.closeField(before.field);
    openBeside(now.field);
  }
  if (now.environment === before.environment) return;
  if (now.environment === "") void app.session.closeEnvironment();
  else openBeside(now.environment);
}

/** The manifest's scene of the number that the state says, or the one at its address; and its field. */
function openScene(manifest: Manifest | undefined): void {
  const { scene, field } = state.value;
  const entry = manifest?.scenes[scene === "" ? manifest.start.scene : Number(scene)];
  status.set({ scenes: manifest?.scenes.map(({ name }) => name) ?? [] });
  if (entry) void app.session.openManifest(entry);
  else if (scene !== "") void app.session.openScene(scene);
  openBeside(field);
}

function openBeside(url: string): void {
  if (url !== "") void app.session.openUrl(url);
}

/** What a manifest wants to be seen first, where the address doesn't say. */
function startOf({ source, compare }: Manifest["start"], { left, right }: ViewerState): Partial<ViewerState> {
  return {
    ...(source !== "" && left === "" && { left: source }),
    ...(compare !== "" && right === "" && { right: compare, compare: "split" as const }),
  };
}
