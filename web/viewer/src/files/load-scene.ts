/** .glb and .gltf to a model, with its baked light. */
import { InputError, readGlb, type TextureLimits } from "@irradia/runtime";
import { irradia } from "@irradia/three/webgpu";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";
import { type GLTF, GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { LoadingManager } from "three/webgpu";
import { type Model, makeModel } from "../scene/model.js";
import { fileName, type NamedFile, wholeBuffer } from "./kinds.js";

const GLB_MAGIC = 0x67;
/** Extensions that need decoders which we leave out, as each weighs more than all of our own code. */
const UNSUPPORTED: Readonly<Record<string, string>> = {
  KHR_draco_mesh_compression: "`irradia bake` undoes Draco: drop its scene.baked.glb.",
  KHR_texture_basisu: "Convert its textures to PNG, JPEG or WebP.",
};

/**
 * @param file the scene
 * @param others files that a .gltf names, when they were dropped with it
 * @throws InputError where the scene, or light in it, is damaged
 */
export async function loadScene(
  file: NamedFile,
  others: readonly NamedFile[],
  limits: TextureLimits,
): Promise<Model> {
  if (!isGltf(file)) readGlb(file.bytes, file.name); // for its errors: GLTFLoader's speak of itself
  checkExtensions(file);
  const { manager, revoke } = managerOf(others);
  const loader = new GLTFLoader(manager).setMeshoptDecoder(MeshoptDecoder);
  loader.register(irradia({ limits }));
  try {
    const gltf = await parse(loader, file);
    const views: { byteLength: number }[] = gltf.parser.json.bufferViews ?? [];
    const viewBytes = views.map(({ byteLength }) => byteLength);
    return makeModel(
      file.name,
      { file: file.bytes.length, views: viewBytes },
      gltf.scene,
      gltf.userData.irradia,
    );
  } catch (error) {
    if (error instanceof InputError) throw error;
    const message = error instanceof Error ? error.message : String(error);
    const fix = "Is the file whole? Khronos' glTF validator says more.";
    throw new InputError(`expected a glTF scene, found: ${message}`, file.name, fix);
  } finally {
    revoke();
  }
}

function parse(loader: GLTFLoader, { bytes }: NamedFile): Promise<GLTF> {
  return loader.parseAsync(wholeBuffer(bytes), "");
}

/** Finds files by their names in place of the network. */
function managerOf(files: readonly NamedFile[]): { manager: LoadingManager; revoke: () => void } {
  const urls = new Map<string, string>();
  for (const { name, bytes } of files) {
    urls.set(fileName(name), URL.createObjectURL(new Blob([bytes as Uint8Array<ArrayBuffer>])));
  }
  const manager = new LoadingManager();
  manager.setURLModifier((url) =>
    /^(blob|data):/.test(url) ? url : (urls.get(fileName(url)) ?? missing(url)),
  );
  return { manager, revoke: () => [...urls.values()].forEach(URL.revokeObjectURL) };
}

function missing(url: string): never {
  throw new InputError(
    "expected a file that the scene names, found none",
    fileName(url),
    "Drop it too, or a .glb.",
  );
}

function isGltf({ name, bytes }: NamedFile): boolean {
  return name.toLowerCase().endsWith(".gltf") && bytes[0] !== GLB_MAGIC;
}

/** three.js says of some of these only that it lacks a decoder, of others nothing. */
function checkExtensions({ name, bytes }: NamedFile): void {
  const text = jsonOf(bytes);
  for (const [extension, fix] of Object.entries(UNSUPPORTED)) {
    const required = /"extensionsRequired"\s*:\s*\[([^\]]*)\]/.exec(text)?.[1] ?? "";
    if (!required.includes(`"${extension}"`)) continue;
    throw new InputError(`expected a scene without ${extension}, found it required`, name, fix);
  }
}

function jsonOf(bytes: Uint8Array): string {
  const isGlb = String.fromCharCode(...bytes.subarray(0, 4)) === "glTF" && bytes.length >= 20;
  if (!isGlb) return new TextDecoder().decode(bytes);
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(12, true);
  return new TextDecoder().decode(bytes.subarray(20, 20 + length));
}
