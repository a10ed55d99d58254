/** Draws /scene.glb with stock three.js into a float target and hands the linear pixels out. */
import {
  FloatType,
  LinearFilter,
  NoToneMapping,
  type Object3D,
  OrthographicCamera,
  Vector3,
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

function camera(view: View): OrthographicCamera {
  const half = view.halfHeight;
  const side = (half * view.width) / view.height;
  const result = new OrthographicCamera(-side, side, half, -half, 0.01, 1000);
  result.up.copy(new Vector3(...view.up));
  result.position.set(...view.eye);
  result.lookAt(...view.target);
  return result;
}
