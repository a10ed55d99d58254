/** Loads a scene with @irradia/three, for either renderer, and draws it step by step. */
import { InputError } from "@irradia/runtime";
import { irradia as irradiaForWebgl, type SceneLight, type View as Shown } from "@irradia/three";
import { irradia as irradiaForWebgpu } from "@irradia/three/webgpu";
import {
  type Camera,
  DataTexture,
  EquirectangularReflectionMapping,
  FloatType,
  type Light,
  type Material,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
} from "three";
import { type GLTF, GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { mozLightmap } from "./moz-lightmap.js";
import type { Drawer } from "./pixels/drawer.js";
import type { Backend } from "./pixels/request.js";
import { WebglDrawer } from "./pixels/webgl-drawer.js";
import { WebgpuDrawer } from "./pixels/webgpu-drawer.js";
import type { Job, Report, Shot, Step } from "./plugin/job.js";
import type { View } from "./view.js";

declare global {
  interface Window {
    runJob: (job: Job) => Promise<Report>;
  }
}

let nCompiled = 0;
countCalls(WebGL2RenderingContext.prototype, "linkProgram");
countCalls(GPUDevice.prototype, "createShaderModule");

/** Counts what any renderer compiles on this page. */
function countCalls<K extends string>(
  prototype: { [key in K]: (...args: never[]) => unknown },
  key: K,
): void {
  const method = prototype[key];
  prototype[key] = function (this: unknown, ...args: never[]): unknown {
    nCompiled += 1;
    return method.apply(this, args);
  };
}

window.runJob = async (job) => {
  try {
    return await drawn(job, await loaded(job));
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    return { backend: job.backend, refusal: error.message, sources: [], shots: [] };
  }
};

async function drawn({ backend, view, plugins, steps }: Job, gltf: GLTF): Promise<Report> {
  const drawer = await drawerOf(backend, view);
  const light: SceneLight | undefined = plugins === "stock" ? undefined : gltf.userData.irradia;
  const scene = new Scene().add(gltf.scene);
  const camera = cameraOf(view);
  const shots: Shot[] = [];
  const worn = new Set<Material>();
  for (const step of steps) {
    if (light) take(step, scene, light);
    const picture = await drawer.draw(scene, camera);
    for (const { mesh } of light?.surfaces ?? []) for (const each of [mesh.material].flat()) worn.add(each);
    shots.push(shotOf(picture, light, worn.size));
  }
  const sources = light?.sources.map(({ name, kind, quantity, isDynamic }) => ({
    name,
    kind,
    quantity,
    isDynamic,
  }));
  return { backend: drawer.backend, sources: sources ?? [], shots };
}

async function drawerOf(backend: Backend, { width, height }: View): Promise<Drawer> {
  return backend === "webgl" ? new WebglDrawer(width, height) : WebgpuDrawer.create(backend, width, height);
}

function loaded({ backend, scene, plugins }: Job): Promise<GLTF> {
  const loader = new GLTFLoader();
  if (plugins !== "irradia") loader.register(mozLightmap);
  if (plugins !== "stock") loader.register(backend === "webgl" ? irradiaForWebgl() : irradiaForWebgpu());
  return loader.loadAsync(scene);
}

function take(step: Step, scene: Scene, light: SceneLight): void {
  const { occlusion, surroundings, use, view, intensity, dynamicSource, surfacesAs, ball } = step;
  if (step.black) edit(light, (material) => material.color.set(0));
  if (occlusion !== undefined) occlude(light, occlusion);
  if (surroundings !== undefined) scene.environment = surroundings > 0 ? evenLight(surroundings) : null;
  if (use !== undefined) light.use(use);
  if (view !== undefined) light.view = view as Shown | null;
  if (surfacesAs !== undefined) light.surfacesAs = surfacesAs;
  if (intensity !== undefined) light.intensity = intensity;
  if (dynamicSource !== undefined) light.dynamicSource = dynamicSource;
  if (ball) addBall(scene, light, ball);
  if (step.dispose) light.dispose();
}

function occlude(light: SceneLight, share: number): void {
  const texture = new DataTexture(new Uint8Array([255 * share, 0, 0, 255]), 1, 1);
  texture.needsUpdate = true;
  edit(light, (material) => {
    material.aoMap = texture;
    material.needsUpdate = true;
  });
}

function edit(light: SceneLight, change: (material: MeshStandardMaterial) => void): void {
  const materials = light.surfaces.flatMap(({ mesh }) => [mesh.material].flat());
  for (const material of new Set(materials.map((each) => light.originalOf(each)))) {
    if (material instanceof MeshStandardMaterial) change(material);
  }
  light.refresh();
}

function evenLight(radiance: number): DataTexture {
  const texels = new Float32Array(4 * 64 * 32).fill(radiance);
  const texture = new DataTexture(texels, 64, 32);
  texture.type = FloatType;
  texture.mapping = EquirectangularReflectionMapping;
  texture.needsUpdate = true;
  return texture;
}

function addBall(
  scene: Scene,
  light: SceneLight,
  { centre, radius, isLit }: NonNullable<Step["ball"]>,
): void {
  const material = new MeshStandardMaterial({ color: 0xffffff, roughness: 1 });
  const ball = new Mesh(new SphereGeometry(radius, 24, 12), material);
  ball.position.set(...centre);
  scene.add(ball);
  if (isLit) light.lit(ball);
}

function shotOf(picture: Float32Array, light: SceneLight | undefined, nMaterials: number): Shot {
  return {
    picture: base64(picture),
    source: light?.source.name ?? "",
    directFrom: light?.directFrom ?? "",
    shining: light?.lights.map(({ visible }: Light) => visible) ?? [],
    bytes: light?.bytes ?? 0,
    nMaterials,
    nCompiled,
  };
}

function cameraOf({ width, height, worldFromCamera, yfovRad }: View): Camera {
  const camera = new PerspectiveCamera(((yfovRad ?? 1) * 180) / Math.PI, width / height, 0.05, 200);
  new Matrix4().fromArray(worldFromCamera).decompose(camera.position, camera.quaternion, camera.scale);
  return camera;
}

function base64(values: Float32Array): string {
  const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
  let text = "";
  for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  return btoa(text);
}
