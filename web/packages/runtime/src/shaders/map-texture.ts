/** Baked pages as textures of shaders. */
import type { LightTexture } from "../formats/ktx2.js";
import { planLightTexture } from "../gpu/light-textures.js";
import type { TextureLimits } from "../gpu/texture.js";
import type { ShaderTexture } from "./light-shader.js";

/**
 * Pages that a text samples by a name.
 *
 * @throws InputError where they are too large for the device
 */
export function mapTexture(name: string, map: LightTexture, limits: TextureLimits): ShaderTexture {
  return { name, plan: planLightTexture(map, limits), data: map.texels, access: "linear" };
}

/** Bytes of textures and of so many vec4s of uniforms. */
export function bytesOf(textures: readonly ShaderTexture[], nVec4: number): number {
  return textures.reduce((sum, { plan }) => sum + plan.nBytes, 16 * nVec4);
}
