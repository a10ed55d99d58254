/** Baked shadows of live lights, as part of the lights' colours. */
import { Color, type DataArrayTexture, type Light } from "three";
import { Fn, float, renderGroup, texture, uniform } from "three/tsl";
import type { Node, NodeBuilder } from "three/webgpu";
import { LIGHTMAP_ATTRIBUTES } from "../types.js";
import { lightmapPlace } from "./inputs.js";

/** What three.js takes for a light's colour in place of its own; spot lights multiply theirs by a function's. */
interface Coloured {
  colorNode: Node<"vec3"> | (() => Node<"float">);
}

/** Multiplies a light by a channel of the mask, on surfaces with a lightmap. Gives what undoes it. */
export function shadowLight(light: Light, mask: DataArrayTexture, channel: number): () => void {
  let isMasked = true;
  const share = Fn((builder: NodeBuilder) => {
    if (!isMasked || !builder.geometry.hasAttribute(LIGHTMAP_ATTRIBUTES.uv)) return float(1);
    const { lightmapUv, page } = lightmapPlace();
    const texel = texture(mask, lightmapUv).depth(page.toInt()).level(float(0)) as unknown as Node<"vec4">;
    return [texel.r, texel.g, texel.b, texel.a][channel] ?? float(1);
  });
  const coloured = light as Light & Partial<Coloured>;
  const undo = () => {
    isMasked = false; // three.js' own node of the light keeps the colour that it was made with
    delete coloured.colorNode;
  };
  if ("isSpotLight" in light) {
    // three.js asks functions, too, for a key.
    coloured.colorNode = Object.assign(() => share() as Node<"float">, { getCacheKey: () => channel });
    return undo;
  }
  const colour = uniform(new Color()).setGroup(renderGroup);
  colour.onRenderUpdate(() => colour.value.copy(light.color).multiplyScalar(light.intensity));
  coloured.colorNode = (colour as unknown as Node<"vec3">).mul(share() as Node<"float">);
  return undo;
}
