/**
 * Reads an OpenEXR or Radiance picture with three.js' loaders.
 *
 *   node dist/checks/read-image.js PICTURE PIXELS.bin
 *
 * Writes RGBA floats in the loader's order of rows to PIXELS.bin, and the size to stdout as JSON.
 */
import { readFileSync, writeFileSync } from "node:fs";
import { FloatType } from "three";
import { EXRLoader } from "three/addons/loaders/EXRLoader.js";
import { HDRLoader } from "three/addons/loaders/HDRLoader.js";

const [picture, pixels] = process.argv.slice(2);
if (!picture || !pixels) throw new Error("usage: read-image.js PICTURE PIXELS.bin");
const loader = picture.endsWith(".exr") ? new EXRLoader() : new HDRLoader();
const bytes = new Uint8Array(readFileSync(picture));
const { width, height, data } = loader.setDataType(FloatType).parse(bytes.buffer);
if (!(data instanceof Float32Array)) throw new Error("the loader gave no floats");
writeFileSync(pixels, new Uint8Array(data.buffer, data.byteOffset, data.byteLength));
process.stdout.write(JSON.stringify({ width, height }));
