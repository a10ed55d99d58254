/** How much of the lightmap's texels can be trusted: docs/IRRADIA_lighting/, "Texel validity". */
import type { BakedLight } from "@irradia/runtime";
import { type DataArrayTexture, NearestFilter, RedFormat } from "three";
import { readPageImages } from "./page-images.js";

type Rgb = readonly [number, number, number];

/** Linear colours of the view; between `hidden` and `whole` a texel's validity mixes. */
export const VALIDITY_COLOURS: Readonly<Record<"outside" | "hidden" | "whole", Rgb>> = {
  outside: [0.08, 0.13, 0.24],
  hidden: [0.75, 0.03, 0.02],
  whole: [0.38, 0.48, 0.4],
};

/** How much darker what faces down is shown than what faces up, so that shapes can be told. */
export const VALIDITY_SHADE = 0.4;

/**
 * The validities of a file, a layer a page; three.js sends them to the GPU when the view is first shown.
 *
 * @returns 0 outside charts, else 1 + 254 · validity; undefined where the file has none
 * @throws InputError where an image is damaged, or of another size than the lightmap
 */
export async function readValidity(baked: BakedLight | undefined): Promise<DataArrayTexture | undefined> {
  const { validity: files, lighting } = baked ?? {};
  if (!files || !lighting?.lightmap) return undefined;
  const texture = await readPageImages(files, lighting.lightmap, 1, "validity");
  texture.name = "irradia_validity";
  texture.format = RedFormat;
  texture.minFilter = texture.magFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}
