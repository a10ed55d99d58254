/** Puts a picture where its camera would have seen it: as high as the window, in the middle. */
import { screenSize, screenUV, step, texture, uniform, vec2, vec4 } from "three/tsl";
import type { Node, RenderTarget, Texture, WebGPURenderer } from "three/webgpu";
import type { Picture } from "../files/picture.js";
import { FullScreen } from "./quad.js";

export class ReferencePass {
  readonly #passes = new Map<Texture, FullScreen>();

  draw(renderer: WebGPURenderer, picture: Picture, target: RenderTarget): void {
    const { texture } = picture;
    const pass = this.#passes.get(texture) ?? new FullScreen(fitted(picture));
    this.#passes.set(texture, pass);
    pass.draw(renderer, target);
  }

  dispose(): void {
    for (const pass of this.#passes.values()) pass.dispose();
  }
}

function fitted({ texture: source, width, height }: Picture): Node<"vec4"> {
  const aspect = uniform(width / height);
  const across = screenUV.x.sub(0.5).mul(screenSize.x.div(screenSize.y)).div(aspect).add(0.5);
  const place = vec2(across, screenUV.y);
  const isInside = step(0, across).mul(step(across, 1));
  return vec4(texture(source, place).rgb.mul(isInside), isInside);
}
