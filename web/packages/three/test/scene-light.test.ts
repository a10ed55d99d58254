import assert from "node:assert/strict";
import { test } from "node:test";
import { InputError } from "@irradia/runtime";
import { Group, type Material, Texture } from "three";
import type { GLTFParser } from "three/addons/loaders/GLTFLoader.js";
import { FileLights } from "../src/core/file-lights.js";
import { BakedSceneLight } from "../src/core/scene-light.js";
import { textureOf } from "../src/core/textures.js";
import type { SurfacesAs } from "../src/types.js";
import { CountedMesh, disposals, madePainter, madeShader } from "./made.js";

function litScene(): { light: BakedSceneLight; mesh: CountedMesh } {
  const mesh = new CountedMesh();
  const scene = new Group().add(mesh);
  const parser = { associations: new Map() } as unknown as GLTFParser;
  const lights = new FileLights(scene, parser, new Set(), new Map());
  const surfaces = [{ mesh, isDynamic: false, rectangles: [] }];
  const loaded = { scene, surfaces, lights, baked: undefined, mask: undefined, validity: undefined };
  return { light: new BakedSceneLight(loaded, madePainter()), mesh };
}

/** A source in use, and how often its texture and the mesh's material have been freed. */
function shown(name: string, { light, mesh }: ReturnType<typeof litScene>, shader = madeShader()) {
  light.add(name, shader);
  light.use(name);
  const [texture] = shader.textures;
  assert(texture);
  return { shader, texture: disposals(textureOf(texture)), material: disposals(mesh.material) };
}

test("a source that is replaced or removed leaves neither textures nor copies of materials", () => {
  const scene = litScene();
  const first = shown("mine", scene);
  const second = shown("mine", scene);
  assert.deepEqual([first.texture(), first.material()], [1, 1]);
  assert.deepEqual([second.texture(), second.material()], [0, 0]);
  scene.light.remove("mine");
  assert.deepEqual([second.texture(), second.material()], [1, 1]);
  assert.equal(scene.light.source.name, "none");
});

test("what another source still reads stays", () => {
  const scene = litScene();
  const { shader, texture, material } = shown("one", scene);
  shown("two", scene, shader);
  scene.light.remove("one");
  assert.deepEqual([texture(), material()], [0, 0]);
  scene.light.remove("two");
  assert.deepEqual([texture(), material()], [1, 1]);
});

test("no source may be called as the one that is always there", () => {
  const { light } = litScene();
  light.add("mine", madeShader());
  assert.throws(() => light.add("none", madeShader()), InputError);
  assert.deepEqual(
    light.sources.map(({ name }) => name),
    ["mine", "none"],
  );
});

test("changes cost one pass over the meshes, and nothing where nothing changes", () => {
  const scene = litScene();
  const { light, mesh } = scene;
  shown("mine", scene);
  mesh.nDressed = 0;
  light.show({ source: "none", view: "normal", screen: new Texture(), dynamicSource: "mine" });
  assert.equal(mesh.nDressed, 1);
  light.use("none");
  light.view = "normal";
  light.screen = new Texture();
  light.dynamicSource = "mine";
  light.show({});
  assert.equal(mesh.nDressed, 1);
});

test("a change that is refused changes nothing", () => {
  const { light } = litScene();
  assert.throws(() => light.show({ view: "normal", source: "nobody" }), InputError);
  assert.throws(() => light.show({ view: "normal", dynamicSource: "none" }), InputError);
  const surfacesAs = "painted" as SurfacesAs;
  assert.throws(() => light.show({ view: "normal", surfacesAs }), InputError);
  assert.equal(light.view, null);
});

test("refreshing makes copies anew, and counts", () => {
  const scene = litScene();
  const { material } = shown("mine", scene);
  const before: Material[] = [scene.mesh.material].flat();
  const { version } = scene.light;
  scene.light.refresh();
  assert.equal(material(), 1);
  assert.notEqual(scene.mesh.material, before[0]);
  assert.equal(scene.light.version, version + 1);
});
