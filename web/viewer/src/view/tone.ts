/** From linear light to what a display shows, as nodes. */

import {
  abs,
  acesFilmicToneMapping,
  agxToneMapping,
  clamp,
  float,
  max,
  mix,
  neutralToneMapping,
  screenUV,
  sRGBTransferOETF,
  texture,
  uniform,
  vec3,
  vec4,
} from "three/tsl";
import type { Node, Texture } from "three/webgpu";
import type { Tone } from "../state/state.js";

/** Behind a scene that ends; coded sRGB. */
const BACKDROP = [0.086, 0.093, 0.102] as const;

const CURVES: Record<Tone, (colour: Node<"vec3">) => Node<"vec3">> = {
  neutral: (colour) => neutralToneMapping(colour, float(1)) as Node<"vec3">,
  aces: (colour) => acesFilmicToneMapping(colour, float(1)) as Node<"vec3">,
  agx: (colour) => agxToneMapping(colour, float(1)) as Node<"vec3">,
  linear: (colour) => clamp(colour, 0, 1),
};

/**
 * What a picture's numbers are: light, E, numbers that displays show as they are, or numbers of either sign,
 * which are squeezed between black and white.
 */
export type Reading = "light" | "irradiance" | "display" | "signed";

/** One side's picture, and how it is to be read. */
export interface SideNodes {
  /** Multiplied by alpha. */
  readonly texel: Node<"vec4">;
  /** To light; 1, or for E 1/π. */
  readonly factor: Node<"float">;
  /** 1 where numbers are shown without exposure and curve. */
  readonly isDisplay: Node<"float">;
  readonly isSigned: Node<"float">;
}

/** A side whose reading can change from frame to frame. */
export class ReadSide implements SideNodes {
  readonly texel: Node<"vec4">;
  readonly factor = uniform(1);
  readonly isDisplay = uniform(0);
  readonly isSigned = uniform(0);

  constructor(picture: Texture) {
    this.texel = texture(picture, screenUV);
  }

  set reading(reading: Reading) {
    this.factor.value = reading === "irradiance" ? 1 / Math.PI : 1;
    this.isSigned.value = reading === "signed" ? 1 : 0;
    this.isDisplay.value = reading === "signed" || reading === "display" ? 1 : 0;
  }
}

/**
 * What a display shows of a side.
 *
 * @param exposure factor on the light
 * @returns linear display values in [0, 1]; alpha as in the picture
 */
export function displayed(side: SideNodes, tone: Tone, exposure: Node<"float">): Node<"vec4"> {
  const alpha = side.texel.a;
  const colour = side.texel.rgb.div(alpha.max(1e-4)).mul(side.factor);
  const toned = clamp(CURVES[tone](max(colour, 0).mul(exposure)), 0, 1);
  const squeezed = colour.div(abs(colour).add(1)).mul(0.5).add(0.5);
  const plain = clamp(mix(colour, squeezed, side.isSigned), 0, 1);
  return vec4(mix(toned, plain, side.isDisplay), alpha);
}

/** Coded sRGB over the backdrop. */
export function coded(shown: Node<"vec4">): Node<"vec3"> {
  return mix(vec3(...BACKDROP), srgb(shown.rgb), clamp(shown.a, 0, 1));
}

/** Linear display values as displays want them. */
export function srgb(linear: Node<"vec3">): Node<"vec3"> {
  return sRGBTransferOETF(linear) as Node<"vec3">;
}
