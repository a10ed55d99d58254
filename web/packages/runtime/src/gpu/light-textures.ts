/** Textures of baked pages. */
import type { LightTexture } from "../formats/ktx2.js";
import { planTexture, type TextureLimits, type TexturePlan } from "./texture.js";

/**
 * The texture of a lightmap or directional map, one layer a page; `texels` are uploaded as they are.
 *
 * Both formats filter on every device. Where a page is larger than the device takes, there is no way but to
 * bake smaller ones: charts of one page can't be split afterwards.
 *
 * @throws InputError where it is too large for the device
 */
export function planLightTexture(light: LightTexture, limits: TextureLimits): TexturePlan {
  const format = light.encoding === "half" ? "rgba16float" : "rgb9e5ufloat";
  return planTexture(format, [light.width, light.height, light.layers], limits, "lightmap");
}
