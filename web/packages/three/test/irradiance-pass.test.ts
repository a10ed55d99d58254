import assert from "node:assert/strict";
import { test } from "node:test";
import { type Material, MeshStandardMaterial, PerspectiveCamera, Scene, Texture } from "three";
import { BaseIrradiancePass, type DrawnTarget, type PassDrawer } from "../src/pass/irradiance-pass.js";
import type { SceneLight } from "../src/types.js";
import { CountedMesh, disposals, madeShader } from "./made.js";

class Drawer implements PassDrawer<DrawnTarget> {
  readonly isBottomUp = true;
  readonly copies: Material[] = [];
  nReleased = 0;
  isDisposed = false;

  sizeTo(): void {}
  resize(): void {}
  drawSurfaces(): void {}
  drawLight(): void {}

  surfaceMaterial(): Material {
    const copy = new MeshStandardMaterial();
    this.copies.push(copy);
    return copy;
  }

  newTarget(): DrawnTarget {
    return { texture: new Texture() };
  }

  release(): void {
    this.nReleased += 1;
  }

  dispose(): void {
    this.isDisposed = true;
  }
}

class Pass extends BaseIrradiancePass<DrawnTarget> {
  constructor(drawer: Drawer, light: SceneLight) {
    super(drawer, light, { resolution: "half" });
  }
}

function drawn() {
  const mesh = new CountedMesh();
  const light = {
    source: { bare: madeShader() },
    surfaces: [{ mesh }],
    view: null,
    version: 0,
    screen: null,
    originalOf: (material: Material) => material,
  };
  const drawer = new Drawer();
  const pass = new Pass(drawer, light as unknown as SceneLight);
  const scene = new Scene().add(mesh);
  const draw = () => pass.render(scene, new PerspectiveCamera());
  return { light, drawer, pass, draw };
}

test("copies of materials last until the scene's materials change", () => {
  const { light, drawer, draw } = drawn();
  draw();
  draw();
  assert.equal(drawer.copies.length, 1);
  const old = disposals(drawer.copies[0]);
  light.version += 1;
  draw();
  draw();
  assert.deepEqual([drawer.copies.length, old()], [2, 1]);
});

test("disposing frees targets, copies and what light is drawn with", () => {
  const { light, drawer, pass, draw } = drawn();
  assert.equal(draw(), true);
  assert.notEqual(light.screen, null);
  const copy = disposals(drawer.copies[0]);
  pass.dispose();
  assert.deepEqual([light.screen, drawer.nReleased, copy(), drawer.isDisposed], [null, 3, 1, true]);
});
