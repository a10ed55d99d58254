/** Full-screen passes. */

import { screenSize, screenUV, texture, vec2 } from "three/tsl";
import {
  HalfFloatType,
  LinearSRGBColorSpace,
  NearestFilter,
  type Node,
  NodeMaterial,
  QuadMesh,
  RenderTarget,
  type Texture,
  type TextureDataType,
  type WebGPURenderer,
} from "three/webgpu";

/** A target of light or numbers, read texel by texel. */
export function makeTarget(samples = 0, type: TextureDataType = HalfFloatType): RenderTarget {
  const target = new RenderTarget(1, 1, { type, samples, depthBuffer: samples > 0 });
  target.texture.minFilter = NearestFilter;
  target.texture.magFilter = NearestFilter;
  target.texture.colorSpace = LinearSRGBColorSpace;
  target.texture.generateMipmaps = false;
  return target;
}

/** One fragment program for every pixel of a target, or of the canvas. */
export class FullScreen {
  readonly #material = new NodeMaterial();
  readonly #quad: QuadMesh;

  constructor(fragment: Node) {
    this.#material.fragmentNode = fragment;
    this.#material.depthTest = false;
    this.#material.depthWrite = false;
    this.#quad = new QuadMesh(this.#material);
  }

  /** @param target null is the canvas */
  draw(renderer: WebGPURenderer, target: RenderTarget | null): void {
    renderer.setRenderTarget(target);
    this.#quad.render(renderer);
    renderer.setRenderTarget(null);
  }

  dispose(): void {
    this.#material.dispose();
  }
}

/** A texel of a target at an offset in pixels from the one that is drawn; edges are repeated. */
export function texelOf(source: Texture): (x: number, y: number) => Node<"vec4"> {
  return (x, y) => texture(source, screenUV.add(vec2(x, y).div(screenSize)));
}
