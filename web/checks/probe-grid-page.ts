/** Loads /probes.three.json into three.js' LightProbeGrid and looks at small white cards in its light. */
import {
  Data3DTexture,
  FloatType,
  HalfFloatType,
  LinearFilter,
  Mesh,
  MeshLambertMaterial,
  NoToneMapping,
  OrthographicCamera,
  PlaneGeometry,
  RGBAFormat,
  Scene,
  Vector3,
  WebGLRenderer,
  WebGLRenderTarget,
} from "three";
import { LightProbeGridWebGL } from "three/addons/lighting/LightProbeGridWebGL.js";

export interface Place {
  position: [number, number, number];
  normal: [number, number, number];
}

declare global {
  interface Window {
    shade: (places: Place[]) => Promise<number[][]>;
  }
}

/** As docs/probes.md prints it. */
async function loadGrid(url: string): Promise<LightProbeGridWebGL> {
  const file = await (await fetch(url)).json();
  const [nx, ny, nz] = file.resolution;
  const grid = new LightProbeGridWebGL(file.width, file.height, file.depth, nx, ny, nz);
  grid.position.fromArray(file.position);
  grid.updateBoundingBox();
  const { width, height, depth, data } = file.texture;
  const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
  const texture = new Data3DTexture(new Uint16Array(bytes.buffer), width, height, depth);
  texture.format = RGBAFormat;
  texture.type = HalfFloatType;
  texture.minFilter = LinearFilter;
  texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  grid.texture = texture;
  return grid;
}

window.shade = async (places) => {
  const scene = new Scene();
  scene.add(await loadGrid("/probes.three.json"));
  const card = new Mesh(new PlaneGeometry(1e-3, 1e-3), new MeshLambertMaterial({ color: 0xffffff }));
  scene.add(card);
  const camera = new OrthographicCamera(-1e-4, 1e-4, 1e-4, -1e-4, 1e-3, 1);
  const renderer = new WebGLRenderer();
  renderer.toneMapping = NoToneMapping;
  const target = new WebGLRenderTarget(1, 1, { type: FloatType });
  renderer.setRenderTarget(target);
  const shades = places.map(({ position, normal }) => {
    const at = new Vector3(...position);
    const above = at.clone().addScaledVector(new Vector3(...normal), 0.1);
    card.position.copy(at);
    card.lookAt(above);
    camera.position.copy(above);
    camera.up.set(0.36, 0.48, 0.8);
    camera.lookAt(at);
    renderer.clear();
    renderer.render(scene, camera);
    const rgba = new Float32Array(4);
    renderer.readRenderTargetPixels(target, 0, 0, 1, 1, rgba);
    return Array.from(rgba.subarray(0, 3));
  });
  if (renderer.getContext().getError() !== 0) throw new Error("WebGL reported an error");
  return shades;
};
