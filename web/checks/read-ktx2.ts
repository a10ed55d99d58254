/**
 * Reads a KTX2 file with Khronos-conformant libraries that aren't ours.
 *
 *   node dist/checks/read-ktx2.js TEXTURE.ktx2 TEXELS.bin
 *
 * Writes the inflated texels to TEXELS.bin and the container's fields to stdout as JSON.
 */
import { readFileSync, writeFileSync } from "node:fs";
import { read } from "ktx-parse";
import { ZSTDDecoder } from "zstddec";

const [texture, texels] = process.argv.slice(2);
if (!texture || !texels) throw new Error("usage: read-ktx2.js TEXTURE.ktx2 TEXELS.bin");
const container = read(new Uint8Array(readFileSync(texture)));
const level = container.levels[0];
if (!level) throw new Error("the texture has no level");
const decoder = new ZSTDDecoder();
await decoder.init();
writeFileSync(texels, decoder.decode(level.levelData, level.uncompressedByteLength));
const { levels, globalData, keyValue, ...fields } = container;
const decodeText = (value: string | Uint8Array) =>
  (typeof value === "string" ? value : new TextDecoder().decode(value)).replace(/\0$/, "");
const text = Object.entries(keyValue).map(([key, value]) => [key, decodeText(value)]);
process.stdout.write(
  JSON.stringify({ ...fields, nLevels: levels.length, keyValue: Object.fromEntries(text) }),
);
