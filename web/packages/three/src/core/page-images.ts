/** Images that go with the lightmap, one for each of its pages, as textures that are read where it is. */
import { expect, type LightmapEntry } from "@irradia/runtime";
import { DataArrayTexture } from "three";
import { type ImageShape, readPng } from "./png.js";

/**
 * A layer a page; texels as they are in the files.
 *
 * @param files PNG images of the lightmap's size
 * @throws InputError where an image is damaged, or of another size or kind
 */
export async function readPageImages(
  files: readonly Uint8Array[],
  { width, height, pages }: LightmapEntry,
  channels: ImageShape["channels"],
  where: string,
): Promise<DataArrayTexture> {
  expect(files.length === pages, `expected ${pages} pages, found ${files.length}`, where);
  const images = await Promise.all(files.map((file) => readPng(file, { width, height, channels }, where)));
  const texels = new Uint8Array(channels * width * height * pages);
  images.forEach((image, page) => {
    texels.set(image, channels * width * height * page);
  });
  return new DataArrayTexture(texels, width, height, pages);
}
