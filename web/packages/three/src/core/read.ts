/** Reads baked light through GLTFLoader's parser, which has the file's bytes. */
import {
  type BakedLight,
  gltfFile,
  readBaked as readBakedFile,
  readLighting,
  viewsOfLighting,
  viewsOfNodes,
} from "@irradia/runtime";
import type { GLTFParser } from "three/addons/loaders/GLTFLoader.js";
import { readyUnzstd } from "./unzstd.js";

/**
 * What the document holds.
 *
 * @returns undefined where it has no light of ours
 * @throws InputError where that is damaged
 */
export async function readBaked(parser: GLTFParser, maxBytes?: number): Promise<BakedLight | undefined> {
  const { json } = gltfFile(parser.json, noView);
  const lighting = readLighting(json);
  if (!lighting) return undefined;
  const indices = [...new Set([...viewsOfLighting(lighting), ...viewsOfNodes(json)])];
  const [unzstd, ...fetched] = await Promise.all([
    readyUnzstd(),
    ...indices.map((index) => parser.getDependency("bufferView", index)),
  ]);
  const views = new Map(indices.map((index, i) => [index, new Uint8Array(fetched[i])]));
  const file = gltfFile(parser.json, (index) => views.get(index) ?? noView(index));
  return readBakedFile(file, { unzstd, maxBytes });
}

function noView(index: number): never {
  throw new Error(`buffer view ${index} was asked for, and nobody announced it`);
}
