/** From linear light to what a display shows, as nodes. */

import {
  acesFilmicToneMapping,
  agxToneMapping,
  clamp,
  float,
  mix,
  neutralToneMapping,
  sRGBTransferOETF,
  vec3,
  vec4,
} from "three/tsl";
import type { Node } from "three/webgpu";
import type { Tone } from "../state/state.js";

/** Behind a scene that ends; coded sRGB. */
const BACKDROP = [0.086, 0.093, 0.102] as const;

const CURVES: Record<Tone, (colour: Node<"vec3">) => Node<"vec3">> = {
  neutral: (colour) => neutralToneMapping(colour, float(1)) as Node<"vec3">,
  aces: (colour) => acesFilmicToneMapping(colour, float(1)) as Node<"vec3">,
  agx: (colour) => agxToneMapping(colour, float(1)) as Node<"vec3">,
  linear: (colour) => clamp(colour, 0, 1),
};

/** How one side's picture is to be read. */
export interface SideNodes {
  /** Linear, multiplied by alpha. */
  readonly texel: Node<"vec4">;
  /** 1 where its numbers are shown as they are: debug views, and pictures that were tone-mapped before. */
  readonly isDisplay: Node<"float">;
}

/**
 * What a display shows of a side.
 *
 * @param exposure factor on the light
 * @returns linear display values in [0, 1]; alpha as in the picture
 */
export function displayed(side: SideNodes, tone: Tone, exposure: Node<"float">): Node<"vec4"> {
  const alpha = side.texel.a;
  const colour = side.texel.rgb.div(alpha.max(1e-4));
  const toned = clamp(CURVES[tone](colour.mul(exposure)), 0, 1);
  return vec4(mix(toned, clamp(colour, 0, 1), side.isDisplay), alpha);
}

/** Coded sRGB over the backdrop. */
export function coded(shown: Node<"vec4">): Node<"vec3"> {
  return mix(vec3(...BACKDROP), srgb(shown.rgb), clamp(shown.a, 0, 1));
}

/** Linear display values as displays want them. */
export function srgb(linear: Node<"vec3">): Node<"vec3"> {
  return sRGBTransferOETF(linear) as Node<"vec3">;
}
