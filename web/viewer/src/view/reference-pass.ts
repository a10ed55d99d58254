/** Puts a picture where its camera would have seen it: as high as the window, in the middle. */
import { floor, fract, mix, screenSize, screenUV, step, texture, vec2, vec4 } from "three/tsl";
import type { Node, RenderTarget, Texture, WebGPURenderer } from "three/webgpu";
import type { Picture } from "../files/picture.js";
import { FullScreen } from "./quad.js";

export class ReferencePass {
  readonly #passes = new Map<Texture, FullScreen>();

  draw(renderer: WebGPURenderer, picture: Picture, target: RenderTarget): void {
    const { texture } = picture;
    const pass = this.#passes.get(texture) ?? this.#make(picture);
    pass.draw(renderer, target);
  }

  dispose(): void {
    for (const texture of [...this.#passes.keys()]) this.#drop(texture);
  }

  /** Lasts as long as its picture. */
  #make(picture: Picture): FullScreen {
    const pass = new FullScreen(fitted(picture));
    this.#passes.set(picture.texture, pass);
    picture.texture.addEventListener("dispose", this.#onDispose);
    return pass;
  }

  readonly #onDispose = ({ target }: { target: Texture }): void => this.#drop(target);

  #drop(texture: Texture): void {
    texture.removeEventListener("dispose", this.#onDispose);
    this.#passes.get(texture)?.dispose();
    this.#passes.delete(texture);
  }
}

function fitted({ texture: source, width, height }: Picture): Node<"vec4"> {
  const across = screenUV.x
    .sub(0.5)
    .mul(screenSize.x.div(screenSize.y))
    .div(width / height)
    .add(0.5);
  const isInside = step(0, across).mul(step(across, 1));
  return vec4(between(source, vec2(across, screenUV.y), vec2(width, height)).mul(isInside), isInside);
}

/** Between four texels, by hand: not every GPU filters 32-bit floats. Where texels lie under pixels, one of them. */
function between(source: Texture, place: Node<"vec2">, size: Node<"vec2">): Node<"vec3"> {
  const texels = place.mul(size).sub(0.5);
  const first = floor(texels).add(0.5);
  const at = (x: number, y: number): Node<"vec3"> => texture(source, first.add(vec2(x, y)).div(size)).rgb;
  const share = fract(texels);
  return mix(mix(at(0, 0), at(1, 0), share.x), mix(at(0, 1), at(1, 1), share.x), share.y);
}
