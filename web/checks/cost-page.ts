/** Times frames in each source of light: inline, and by a pass over the screen. */
import { fieldShader, readField } from "@irradia/runtime";
import type { SceneLight } from "@irradia/three";
import { type Camera, Scene } from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import type { CostAnswer, CostRequest, How, Timing } from "./cost/request.js";
import { cameraOf } from "./pixels/camera.js";
import type { Drawer, ScreenPass } from "./pixels/drawer.js";
import { newDrawer } from "./pixels/new-drawer.js";

declare global {
  interface Window {
    cost: (request: CostRequest) => Promise<CostAnswer>;
  }
}

const MAX_DIFFERENCE = 0.01; // of the picture's sum

interface Stand {
  readonly timing: Timing;
  readonly pass: ScreenPass | undefined;
}

window.cost = async (request) => {
  const drawer = await newDrawer(request.backend, request.view);
  const { scene, light } = await load(drawer, request);
  const camera = cameraOf(request.view);
  const stands = request.sources.flatMap((source): Stand[] => {
    const hows: How[] = request.screened.includes(source) ? ["inline", "full", "half"] : ["inline"];
    return hows.map((how) => ({
      timing: { source, how, milliseconds: [] },
      pass: drawer.newPass(light, how),
    }));
  });
  await checkAgreement(drawer, light, stands, scene, camera); // compiles, too
  for (let round = 0; round < request.rounds; round++) {
    for (const stand of stands) {
      stand.timing.milliseconds.push(await draw(drawer, light, stand, scene, camera));
    }
  }
  return { backend: drawer.backend, timings: stands.map(({ timing }) => timing), costs: costsOf(light) };
};

async function load(drawer: Drawer, request: CostRequest): Promise<{ scene: Scene; light: SceneLight }> {
  const gltf = await new GLTFLoader().register(drawer.plugin).loadAsync(request.scene);
  const light: SceneLight = gltf.userData.irradia;
  for (const [name, path] of Object.entries(request.fields)) {
    const bytes = await (await fetch(path)).arrayBuffer();
    light.add(name, fieldShader(readField(new Uint8Array(bytes)), drawer.limits));
  }
  return { scene: new Scene().add(gltf.scene), light };
}

/** Refuses to time what doesn't show the same: passes at full resolution against materials. */
async function checkAgreement(
  drawer: Drawer,
  light: SceneLight,
  stands: readonly Stand[],
  scene: Scene,
  camera: Camera,
): Promise<void> {
  let inline: Float32Array = new Float32Array();
  for (const { timing, pass } of stands) {
    choose(light, timing.source, pass);
    const picture = await drawer.draw(scene, camera, pass);
    if (timing.how === "inline") inline = picture;
    const difference = inline.reduce((sum, value, i) => sum + Math.abs(value - (picture[i] ?? 0)), 0);
    const share = difference / inline.reduce((sum, value) => sum + value, 0);
    if (timing.how === "full" && !(share < MAX_DIFFERENCE)) {
      throw new Error(`${timing.source}: a pass shows something else than materials: ${share}`);
    }
  }
}

function choose(light: SceneLight, source: string, pass: ScreenPass | undefined): void {
  light.use(source);
  if (!pass) light.screen = null;
}

/** Milliseconds until a frame is done. */
async function draw(
  drawer: Drawer,
  light: SceneLight,
  { timing, pass }: Stand,
  scene: Scene,
  camera: Camera,
): Promise<number> {
  choose(light, timing.source, pass);
  await drawer.finish();
  const start = performance.now();
  drawer.show(scene, camera, pass);
  await drawer.finish();
  return performance.now() - start;
}

function costsOf(light: SceneLight): CostAnswer["costs"] {
  const costs = light.sources.flatMap(({ name, shader }) =>
    shader ? [[name, { ...shader.cost }] as const] : [],
  );
  return Object.fromEntries(costs);
}
