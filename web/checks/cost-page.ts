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
  for (const stand of stands) await draw(drawer, light, stand, scene, camera); // compiles
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

/** Milliseconds until a frame is done. */
async function draw(
  drawer: Drawer,
  light: SceneLight,
  { timing, pass }: Stand,
  scene: Scene,
  camera: Camera,
): Promise<number> {
  light.use(timing.source);
  if (!pass) light.screen = null;
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
