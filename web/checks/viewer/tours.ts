/** What tests look at, several things in one browser, as a browser takes its time to start. */
import { mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import type { CDPSession } from "playwright-core";
import type { Driver, Told } from "./driver.js";

type Tour = (driver: Driver) => Promise<Record<string, unknown>>;

const SCENE = "/files/scene.glb";
/** Files that aren't what they say; tests/web/viewer_files.py makes them. */
const HOSTILE = [
  "cut.glb",
  "no-json.glb",
  "light.glb",
  "cut.safetensors",
  "cut.safetensors.zst",
  "infinite.safetensors",
  "cut.bin",
  "cut.hdr",
  "cut.exr",
  "cut.png",
  "notes.txt",
  "empty.glb",
];

/** Drag and drop of every kind of file. */
async function drops(driver: Driver): Promise<Record<string, unknown>> {
  const ids = async (): Promise<unknown> => driver.page.evaluate(choiceIds);
  const told: Record<string, Told> = { empty: await driver.open("") };
  const invitation = await driver.texts(".invitation h1");
  told.early = await driver.drop("/files/field.safetensors");
  const early = await driver.texts(".problem");
  told.scene = await driver.drop(SCENE);
  const first = { ids: await ids(), picture: await driver.picture() };
  await driver.drop("/files/field.safetensors", "/files/field.safetensors.zst", "/files/field.bin");
  const afterFields = await ids();
  await driver.drop("/files/render.png", "/files/render.hdr", "/files/render.exr");
  const afterPictures = await ids();
  await driver.set({ left: "none" });
  const dark = await driver.picture();
  told.sky = await driver.drop("/files/sky.hdr");
  const sky = await driver.picture();
  await driver.drop("/files/camera.json");
  const { camera } = await driver.state();
  return { told, invitation, early, first, afterFields, afterPictures, dark, sky, camera };
}

/** Two sides: the slider, the difference, FLIP. */
async function sides(driver: Driver): Promise<Record<string, unknown>> {
  await driver.open(`?scene=${SCENE}&left=lightmap&right=field&panel=0&ev=0&tone=linear`);
  const pictures: Record<string, string> = { lightmap: await driver.picture() };
  await driver.set({ left: "field" });
  pictures.field = await driver.picture();
  await driver.set({ left: "lightmap", compare: "split", split: 0.25 });
  pictures.split = await driver.picture();
  await driver.page.locator(".handle").hover();
  await driver.page.mouse.down();
  await driver.page.mouse.move(192, 100);
  await driver.page.mouse.up();
  const { split } = await driver.state();
  await driver.set({ compare: "difference", gain: 4 });
  pictures.difference = await driver.picture();
  const numbers = await driver.status("difference");
  await driver.set({ compare: "error" });
  pictures.error = await driver.picture();
  const shown = await driver.texts(".numbers");
  await driver.set({ probes: "dc", object: "sphere", compare: "difference" });
  const withGuests = await driver.status("difference");
  pictures.guests = await driver.picture();
  await driver.set({ probes: "off", object: "off" });
  await driver.set({ left: "three-probes", compare: "single" });
  pictures["three-probes"] = await driver.picture();
  await driver.set({ left: "lightmap", right: "lightmap", compare: "error" });
  const same = await driver.status("difference");
  pictures.noError = await driver.picture();
  return { pictures, split, numbers, shown, withGuests, same };
}

/** Each view, of the field and of the lightmap. */
async function views(driver: Driver): Promise<Record<string, unknown>> {
  await driver.open(`?scene=${SCENE}&left=field&panel=0`);
  const possible = { field: await driver.status("views") };
  const pictures: Record<string, string> = {};
  for (const view of possible.field as string[]) {
    await driver.set({ view });
    pictures[view] = await driver.picture();
  }
  await driver.set({ view: "light", left: "probes" });
  const ofProbes = await driver.status("views");
  await driver.set({ view: "validity" });
  pictures.validity = await driver.picture();
  await driver.set({ view: "light", tone: "linear" });
  for (const probes of ["off", "irradiance", "direction", "dc", "validity"]) {
    await driver.set({ probes });
    pictures[`probes ${probes}`] = await driver.picture();
  }
  const ev = await driver.status("ev");
  await driver.set({ probes: "off", tone: "neutral" });
  for (const pass of ["full", "half"]) {
    await driver.set({ pass, left: "field" });
    pictures[`pass ${pass}`] = await driver.picture();
  }
  const surfaces: Record<string, string> = {};
  await driver.set({ pass: "inline", object: "sphere" }); // walls have no specular part
  surfaces.baked = await driver.picture();
  await driver.page.getByText("Materials", { exact: true }).dispatchEvent("click");
  await driver.settled();
  surfaces.materials = await driver.picture();
  await driver.set({ surfaces: "baked" });
  surfaces.again = await driver.picture();
  return { possible: { ...possible, probes: ofProbes }, pictures, ev, surfaces };
}

/** A link shows what its sender saw. */
async function links(driver: Driver): Promise<Record<string, unknown>> {
  await driver.open(`?scene=${SCENE}`);
  const camera = { eye: [0.3, 0.3, -0.4], target: [0.25, 0.2, 0.3], yfovDeg: 50 };
  const wanted = { left: "field", right: "probes", compare: "split", split: 0.3, tone: "aces", ev: 0.5 };
  await driver.set({ ...wanted, camera, object: "sphere", place: [0.3, 0.2, 0.2], panel: false });
  const before = { state: await driver.state(), picture: await driver.picture() };
  await driver.page.waitForFunction(() => location.hash.includes("tone=aces"));
  const hash = await driver.page.evaluate(() => location.hash);
  await driver.open(`?scene=${SCENE}${hash}`);
  const after = { state: await driver.state(), picture: await driver.picture() };
  await driver.page.evaluate(() => {
    location.hash = location.hash.replace("tone=aces", "tone=agx");
  });
  await driver.page.waitForFunction(() => irradiaViewer.state.value.tone === "agx");
  await driver.page.evaluate(() => {
    location.hash = "#left=lightmap";
  });
  await driver.page.waitForFunction(() => irradiaViewer.state.value.tone === "neutral");
  const plain = (await driver.state()).camera;
  await driver.settled();
  const home = await driver.picture();
  await driver.open(`?scene=${SCENE}&left=lightmap`);
  const fresh = await driver.picture();
  await driver.set({ camera, place: [0.3, 0.2, 0.2] });
  await driver.dropOneAfterAnother([SCENE], ["/files/field.safetensors"], ["/files/render.png"]);
  const { camera: kept, place } = await driver.state();
  const dropped = { ids: await driver.page.evaluate(choiceIds), kept, place, told: await driver.told() };
  return { hash, before, after, plain, home, fresh, dropped };
}

/** Files that are damaged; the scene before stays. */
async function hostile(driver: Driver): Promise<Record<string, unknown>> {
  await driver.open(`?scene=${SCENE}`);
  const before = await driver.picture();
  const panels: Record<string, unknown> = {};
  for (const file of HOSTILE) {
    const told = await driver.drop(`/files/${file}`);
    panels[file] = { told, texts: await driver.texts(".problem") };
  }
  await driver.page.locator(".problem button").first().click();
  const closed = await driver.texts(".problem");
  const focused = await driver.page.evaluate(() => document.activeElement?.className);
  const after = await driver.picture();
  const folder = await mkdtemp(`${tmpdir()}/irradia-`);
  await writeFile(`${folder}/notes.txt`, "not a scene");
  await driver.dropPath(folder);
  const folderTexts = await driver.texts(".problem");
  const lost = await driver.open("?scene=/files/nowhere.glb");
  const lostTexts = await driver.texts(".problem");
  return { before, after, panels, closed, focused, folderTexts, lost, lostTexts };
}

/** Hands on the picture: keys, pointer, fingers, windows of other sizes. */
async function hands(driver: Driver): Promise<Record<string, unknown>> {
  const { page } = driver;
  await driver.open(`?scene=${SCENE}&left=lightmap&panel=0&object=sphere&place=0.28,0.27,-0.2`);
  const places = [(await driver.state()).place];
  await page.mouse.move(128, 44 + 72);
  await page.mouse.down();
  await page.mouse.move(150, 44 + 72);
  await page.mouse.up();
  await driver.settled();
  places.push((await driver.state()).place);
  const still = (await driver.state()).camera;
  await page.mouse.move(40, 100);
  await page.mouse.down();
  await page.mouse.move(60, 110, { steps: 4 });
  await page.mouse.up();
  await driver.settled();
  const orbited = (await driver.state()).camera;
  await page.keyboard.press("2");
  await page.keyboard.down("w");
  await page.waitForTimeout(300);
  await page.keyboard.up("w");
  await driver.settled();
  const flown = (await driver.state()).camera;
  await page.mouse.move(40, 100);
  await page.mouse.down({ button: "right" });
  await page.mouse.move(40, 112, { steps: 3 });
  await page.mouse.up({ button: "right" });
  await driver.settled();
  const strode = (await driver.state()).camera;
  const inside = { eye: [0.3, 0.45, 0.15], target: [0.3, 0.3, 0.5], yfovDeg: 50 };
  await driver.set({ camera: inside, object: "off" });
  await page.keyboard.press("3");
  await page.keyboard.down("w");
  await page.waitForTimeout(1500);
  await page.keyboard.up("w");
  await driver.settled();
  const walked = (await driver.state()).camera;
  await page.keyboard.press("c");
  await page.keyboard.press("?");
  const isHelpOpen = await page.locator("dialog.help").isVisible();
  await page.keyboard.press("Escape");
  const { compare, navigation } = await driver.state();
  await page.locator(".handle").focus();
  await page.keyboard.press("ArrowRight");
  await driver.settled();
  const { split, camera: afterArrow } = await driver.state();
  await page.setViewportSize({ width: 200, height: 300 });
  await driver.settled();
  const size = await page.evaluate(canvasSize);
  const session = await page.context().newCDPSession(page);
  const metrics = { width: 200, height: 300, deviceScaleFactor: 2, mobile: false };
  await session.send("Emulation.setDeviceMetricsOverride", metrics);
  await page.waitForFunction(() => document.querySelector("canvas")?.width === 400);
  await driver.settled();
  const dense = await page.evaluate(canvasSize);
  await page.keyboard.press("n");
  const panel = await page.locator(".panel").boundingBox();
  const statistics = await driver.status("statistics");
  await page.locator("label", { hasText: /^Fly$/ }).click();
  await page.keyboard.press("v");
  const afterRadio = await driver.state();
  return {
    strode,
    split,
    afterArrow,
    afterRadio,
    places,
    still,
    orbited,
    flown,
    walked,
    isHelpOpen,
    compare,
    navigation,
    size,
    dense,
    panel,
    statistics,
  };
}

/** A screen that is touched. */
async function fingers(driver: Driver): Promise<Record<string, unknown>> {
  const session = await driver.page.context().newCDPSession(driver.page);
  await session.send("Emulation.setTouchEmulationEnabled", { enabled: true, maxTouchPoints: 2 });
  const camera = { eye: [0.28, 0.27, -0.3], target: [0.28, 0.27, 0.2], yfovDeg: 50 };
  await driver.open(`?scene=${SCENE}&left=lightmap&panel=0`);
  await driver.set({ camera });
  const see = async (): Promise<unknown> => {
    await driver.settled();
    return (await driver.state()).camera;
  };
  await touch(session, [[60, 100]], [40, 10]);
  const orbited = await see();
  await driver.set({ camera, navigation: "fly" });
  await touch(session, [[60, 100]], [40, 10]);
  const looked = await see();
  await driver.set({ camera });
  await touch(session, [[60, 100], [120, 100]], [0, 20]); // biome-ignore format: a pair of places
  const strode = await see();
  await driver.set({ compare: "split" });
  await touch(session, [[128, 80]], [64, 0]);
  const { split } = await driver.state();
  return { orbited, looked, strode, split };
}

/** Fingers go down at some places and the same way together. */
async function touch(session: CDPSession, places: number[][], way: number[]): Promise<void> {
  const at = (share: number) =>
    places.map(([x = 0, y = 0], id) => ({ x: x + share * (way[0] ?? 0), y: y + share * (way[1] ?? 0), id }));
  await session.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: at(0) });
  for (const share of [0.25, 0.5, 0.75, 1]) {
    await session.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: at(share) });
  }
  await session.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
}

/** A browser without WebGPU, whose context is lost as well. */
async function webgl2(driver: Driver): Promise<Record<string, unknown>> {
  await driver.page.addInitScript("Object.defineProperty(Navigator.prototype, 'gpu', { value: undefined })");
  const told = await driver.open(`?scene=${SCENE}&left=directional&right=field&compare=split&panel=0`);
  const before = await driver.picture();
  await driver.set({ compare: "error" });
  const difference = await driver.status("difference");
  await driver.set({ compare: "split" });
  const waiting = driver.page.evaluate(untilOtherCanvas);
  await driver.page.evaluate(loseContext);
  const messages = await waiting;
  await driver.settled();
  return {
    told,
    before,
    difference,
    messages,
    after: await driver.picture(),
    recovered: await driver.told(),
  };
}

/** The GPU's process ends, as after a driver's mistake. */
async function crash(driver: Driver): Promise<Record<string, unknown>> {
  const told = await driver.open(`?scene=${SCENE}&left=lightmap&panel=0`);
  const before = await driver.picture();
  const waiting = driver.page.evaluate(untilOtherCanvas);
  const browser = await driver.page.context().browser()?.newBrowserCDPSession();
  await browser?.send("Browser.crashGpuProcess").catch(() => {}); // it ends before it answers
  const messages = await waiting;
  await driver.settled();
  return { told, before, messages, after: await driver.picture(), recovered: await driver.told() };
}

/** A page that holds its scene itself, and a kiosk. */
async function kept(driver: Driver): Promise<Record<string, unknown>> {
  const base = driver.base.replace("/built/", "/kept/");
  await driver.page.goto(`${base}?kiosk=1&view=0`);
  await driver.page.waitForFunction("globalThis.irradiaViewer");
  await driver.page.evaluate(() => irradiaViewer.ready);
  const chrome = await driver.page.locator(".bar, .panel").count();
  const { camera } = await driver.state();
  return { told: await driver.told(), choices: await driver.page.evaluate(choiceIds), chrome, camera };
}

export const TOURS: Readonly<Record<string, Tour>> = {
  drops,
  sides,
  views,
  links,
  hostile,
  hands,
  fingers,
  webgl2,
  crash,
  kept,
};

function choiceIds(): string[] {
  return (irradiaViewer.status.value.choices as { id: string }[]).map(({ id }) => id);
}

function canvasSize(): { canvas: number[]; layout: number[] } {
  const canvas = document.querySelector("canvas");
  const { clientWidth, clientHeight } = canvas ?? { clientWidth: 0, clientHeight: 0 };
  return { canvas: [canvas?.width ?? 0, canvas?.height ?? 0], layout: [clientWidth, clientHeight] };
}

/** What the page says until it has a context again. */
async function untilOtherCanvas(): Promise<string[]> {
  const messages: string[] = [];
  const end = irradiaViewer.status.subscribe(() => messages.push(String(irradiaViewer.status.value.message)));
  const canvas = document.querySelector("canvas");
  while (document.querySelector("canvas") === canvas) await new Promise((resolve) => setTimeout(resolve, 20));
  end();
  return messages;
}

function loseContext(): void {
  document.querySelector("canvas")?.getContext("webgl2")?.getExtension("WEBGL_lose_context")?.loseContext();
}
