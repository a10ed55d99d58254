/** Baked shadows of lights that shine live: docs/shadow_mask.md. */
import { type BakedLight, expect } from "@irradia/runtime";
import { DataArrayTexture, type Light, LinearFilter } from "three";
import { readPng } from "./png.js";

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
  const { width, height, pages } = lighting.lightmap;
  expect(files.length === pages, `expected ${pages} pages, found ${files.length}`, "shadow mask");
  const images = await Promise.all(files.map((file) => readPng(file, [width, height], "shadow mask")));
  const texels = new Uint8Array(4 * width * height * pages);
  images.forEach((image, page) => {
    texels.set(image.texels, 4 * width * height * page);
  });
  const texture = new DataArrayTexture(texels, width, height, pages);
  texture.name = "irradia_shadow_mask";
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return { texture, channels };
}
