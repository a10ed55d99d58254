/** Baked shadows of lights that shine live: docs/shadow_mask.md. */
import type { BakedLight } from "@irradia/runtime";
import { type DataArrayTexture, type Light, LinearFilter } from "three";
import { readPageImages } from "./page-images.js";

export interface ShadowMask {
  /** A layer a page, four lights a texel, sampled as the lightmap is. */
  readonly texture: DataArrayTexture;
  /** Only lights with a channel. */
  readonly channels: ReadonlyMap<Light, number>;
}

/**
 * The mask of a file.
 *
 * @param channels by light; without any there is nothing to mask
 * @throws InputError where an image is damaged, or of another size than the lightmap
 */
export async function readShadowMask(
  baked: BakedLight | undefined,
  channels: ReadonlyMap<Light, number>,
): Promise<ShadowMask | undefined> {
  const { shadowMask: files, lighting } = baked ?? {};
  if (!files || !lighting?.lightmap || channels.size === 0) return undefined;
  const texture = await readPageImages(files, lighting.lightmap, 4, "shadow mask");
  texture.name = "irradia_shadow_mask";
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return { texture, channels };
}
