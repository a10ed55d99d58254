/** Draws /scene.glb with stock three.js into a float target and hands the linear pixels out. */
import {
  type Camera,
  FloatType,
  LinearFilter,
  MathUtils,
  Matrix4,
  NoToneMapping,
  type Object3D,
  OrthographicCamera,
  PerspectiveCamera,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { mozLightmap } from "./moz-lightmap.js";
import type { Drawing, View } from "./view.js";

declare global {
  interface Window {
    draw: (view: View) => Promise<Drawing>;
  }
}

window.draw = async (view) => {
  const loader = new GLTFLoader().register(mozLightmap);
  const { scene, animations } = await loader.loadAsync("/scene.glb");
  const pixels = render(scene, view);
  return { pixels, nAnimations: animations.length };
};

function render(scene: Object3D, view: View): number[] {
  const renderer = new WebGLRenderer();
  renderer.toneMapping = NoToneMapping;
  const target = new WebGLRenderTarget(view.width, view.height, { type: FloatType, minFilter: LinearFilter });
  renderer.setRenderTarget(target);
  renderer.clear();
  renderer.render(scene, camera(view));
  const rgba = new Float32Array(view.width * view.height * 4);
  renderer.readRenderTargetPixels(target, 0, 0, view.width, view.height, rgba);
  if (renderer.getContext().getError() !== 0) throw new Error("WebGL reported an error");
  return Array.from(rgba);
}

function camera(view: View): Camera {
  const result = projection(view);
  new Matrix4().fromArray(view.worldFromCamera).decompose(result.position, result.quaternion, result.scale);
  return result;
}

function projection({ width, height, halfHeightM, yfovRad }: View): Camera {
  const aspect = width / height;
  if (yfovRad !== undefined) return new PerspectiveCamera(MathUtils.radToDeg(yfovRad), aspect, 0.01, 1000);
  if (halfHeightM === undefined) throw new Error("a view needs halfHeightM or yfovRad");
  const side = halfHeightM * aspect;
  return new OrthographicCamera(-side, side, halfHeightM, -halfHeightM, 0.01, 1000);
}
