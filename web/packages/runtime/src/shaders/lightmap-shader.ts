/** A plain lightmap as a source of light: one fetch a pixel. */
import type { Quantity } from "../field/spec.js";
import type { LightTexture } from "../formats/ktx2.js";
import type { TextureLimits } from "../gpu/texture.js";
import { composeText } from "./compose.js";
import type { LightShader } from "./light-shader.js";
import { bytesOf, mapTexture } from "./map-texture.js";

/**
 * @param lightmap texels times `scale` are E/π
 * @param quantity what was baked into it
 * @throws InputError where its pages are too large for the device
 */
export function lightmapShader(
  lightmap: LightTexture,
  scale: number,
  quantity: Quantity,
  limits: TextureLimits,
): LightShader {
  const textures = [mapTexture("irradia_lightmap", lightmap, limits)];
  return {
    entry: "irradia_light",
    inputs: ["lightmapUv", "page"],
    textures,
    uniforms: [{ name: "irradia_map_scales", values: Float32Array.of(Math.PI * scale, 0, 0, 0) }],
    quantity,
    cost: { flops: 6, fetches: 1, bytes: bytesOf(textures, 1) },
    views: {},
    text: (language) => composeText(language, ["lightmap-light"]),
  };
}
