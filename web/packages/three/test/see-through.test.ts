import assert from "node:assert/strict";
import { test } from "node:test";
import { BoxGeometry, type Material, Mesh, MeshPhysicalMaterial, PlaneGeometry } from "three";
import type { Shading } from "../src/core/painter.js";
import { Wardrobe } from "../src/core/wardrobe.js";
import { madePainter, madeShader } from "./made.js";

const light = madeShader();
const baked: Shading = {
  light,
  seeThrough: light,
  baked: "whole",
  direct: undefined,
  lamps: undefined,
  view: null,
  mask: undefined,
  validity: undefined,
  lightmap: undefined,
};
const plain: Shading = { ...baked, baked: undefined };

function pane(geometry = new PlaneGeometry()): { mesh: Mesh; glass: MeshPhysicalMaterial } {
  const glass = new MeshPhysicalMaterial({ transmission: 1, clearcoat: 1, transparent: true });
  return { mesh: new Mesh(geometry, glass), glass };
}

function partsOf({ material }: Mesh): Material[] {
  assert(Array.isArray(material));
  return material;
}

test("a pane is drawn twice, tint before light, and the same materials come back", () => {
  const [{ mesh }, wardrobe] = [pane(), new Wardrobe(madePainter())];
  wardrobe.dress(mesh, baked);
  const parts = partsOf(mesh);
  assert.deepEqual(
    mesh.geometry.groups.map(({ start, count, materialIndex }) => [start, count, materialIndex]),
    [
      [0, 6, 0],
      [0, 6, 1],
    ],
  );
  wardrobe.dress(mesh, plain);
  assert(!Array.isArray(mesh.material));
  wardrobe.dress(mesh, baked);
  assert.deepEqual(partsOf(mesh), parts);
  assert.equal(mesh.geometry.groups.length, 2);
});

test("the tint is the same whatever the light", () => {
  const [{ mesh }, wardrobe] = [pane(), new Wardrobe(madePainter())];
  wardrobe.dress(mesh, baked);
  const [tint, own] = partsOf(mesh);
  const other = madeShader();
  wardrobe.dress(mesh, { ...baked, light: other, seeThrough: other });
  assert.equal(partsOf(mesh)[0], tint);
  assert.notEqual(partsOf(mesh)[1], own);
});

test("a pane that is undressed has its own material again", () => {
  const [{ mesh, glass }, wardrobe] = [pane(), new Wardrobe(madePainter())];
  wardrobe.dress(mesh, baked);
  for (const part of partsOf(mesh)) assert.equal(wardrobe.originalOf(part), glass);
  wardrobe.undress(mesh);
  assert.equal(mesh.material, glass);
});

test("a pane whose geometry is in groups already is left as it is", () => {
  const [{ mesh }, wardrobe] = [pane(new BoxGeometry()), new Wardrobe(madePainter())];
  wardrobe.dress(mesh, baked);
  assert(!Array.isArray(mesh.material));
  assert.equal(mesh.geometry.groups.length, 6);
});
