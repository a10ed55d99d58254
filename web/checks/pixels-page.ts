/** Draws a scene in its baked light, and what Python needs to work out the same pixels. */
import { fieldShader, readField } from "@irradia/runtime";
import type { SceneLight } from "@irradia/three";
import { AmbientLight, BufferAttribute, Mesh, type Object3D, Scene } from "three";
import { type GLTF, GLTFLoader, type GLTFParser } from "three/addons/loaders/GLTFLoader.js";
import { cameraOf } from "./pixels/camera.js";
import type { Drawer } from "./pixels/drawer.js";
import { newDrawer } from "./pixels/new-drawer.js";
import type { Answer, Request } from "./pixels/request.js";

declare global {
  interface Window {
    pixels: (request: Request) => Promise<Answer>;
  }
}

window.pixels = async (request) => {
  const drawer = await newDrawer(request.backend, request.view);
  const pictures = new Map<string, Float32Array>();
  const objects = request.channels.length > 0 ? await drawChannels(drawer, request, pictures) : [];
  await drawPictures(drawer, request, pictures);
  return {
    backend: drawer.backend,
    pictures: Object.fromEntries([...pictures].map(([name, values]) => [name, base64(values)])),
    objects,
  };
};

async function drawChannels(
  drawer: Drawer,
  { scene: path, view, channels }: Request,
  pictures: Map<string, Float32Array>,
): Promise<Answer["objects"]> {
  const gltf = await new GLTFLoader().loadAsync(path);
  const objects = numberObjects(gltf);
  const ambient = new AmbientLight(0xffffff, 1);
  const scene = new Scene().add(gltf.scene, ambient);
  for (const mesh of seeThroughOf(scene)) mesh.visible = false;
  const show = drawer.showChannels(scene);
  for (const channel of channels) {
    ambient.intensity = channel === "white" ? 1 : 0;
    show(channel);
    pictures.set(channel, await drawer.draw(scene, cameraOf(view)));
  }
  show(undefined);
  return objects;
}

async function drawPictures(
  drawer: Drawer,
  request: Request,
  pictures: Map<string, Float32Array>,
): Promise<void> {
  const gltf = await new GLTFLoader().register(drawer.plugin).loadAsync(request.scene);
  const light: SceneLight = gltf.userData.irradia;
  for (const [name, path] of Object.entries(request.fields)) {
    const bytes = await (await fetch(path)).arrayBuffer();
    light.add(name, fieldShader(readField(new Uint8Array(bytes)), drawer.limits));
  }
  const scene = new Scene().add(gltf.scene);
  const seeThrough = seeThroughOf(scene);
  for (const [name, { source, how, surfacesAs = "materials" }] of Object.entries(request.pictures)) {
    for (const mesh of seeThrough) mesh.visible = surfacesAs === "baked";
    light.show({ source, surfacesAs });
    const pass = drawer.newPass(light, how);
    pictures.set(name, await drawer.draw(scene, cameraOf(request.view), pass));
    pass?.dispose();
  }
}

/** What shows through a surface isn't told by what the surface's pixel shows. */
function seeThroughOf(scene: Object3D): Mesh[] {
  const found: Mesh[] = [];
  scene.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    const { transparent, transmission = 0 } = object.material;
    if (transparent || transmission > 0) found.push(object);
  });
  return found;
}

/** Gives each mesh attributes for its number and its lightmap's uv, the set that the file says. */
function numberObjects({ scene, parser }: GLTF): Answer["objects"] {
  const objects: Answer["objects"] = [];
  scene.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    const place = placeOf(object, parser);
    objects.push(place);
    object.geometry = object.geometry.clone();
    const count = object.geometry.getAttribute("position").count;
    const numbers = new Float32Array(count).fill(objects.length);
    object.geometry.setAttribute("objectNumber", new BufferAttribute(numbers, 1));
    const lighting = parser.json.nodes[place.node].extensions?.IRRADIA_lighting;
    const texCoord = lighting?.primitives?.[place.primitive]?.texCoord;
    const uv =
      object.geometry.getAttribute(`uv${texCoord}`) ?? new BufferAttribute(new Float32Array(2 * count), 2);
    object.geometry.setAttribute("lightmapUv", uv);
  });
  return objects;
}

function placeOf(mesh: Mesh, parser: GLTFParser): Answer["objects"][number] {
  const known = (object: Object3D) => parser.associations.get(object);
  const node = known(mesh)?.nodes ?? (mesh.parent && known(mesh.parent)?.nodes);
  if (node === undefined || node === null) throw new Error(`${mesh.name} belongs to no node`);
  const isOwn = known(mesh)?.nodes !== undefined;
  return { node, primitive: isOwn ? 0 : (mesh.parent?.children.indexOf(mesh) ?? 0) };
}

function base64(values: Float32Array): string {
  const bytes = new Uint8Array(values.buffer, values.byteOffset, values.byteLength);
  let text = "";
  for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  return btoa(text);
}
