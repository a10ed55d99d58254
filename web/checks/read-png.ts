/**
 * Reads images as @irradia/three reads shadow masks (4 channels) and validities (1).
 *
 *   node dist/checks/read-png.js WIDTH HEIGHT CHANNELS IMAGE.png…
 *
 * For each image its texels in base64, or why it was refused, go to stdout as JSON.
 */
import { readFileSync } from "node:fs";
import { InputError } from "@irradia/runtime";
import { readPng } from "../packages/three/src/core/png.js";

const [width, height, channels, ...images] = process.argv.slice(2);
if (images.length === 0) throw new Error("usage: read-png.js WIDTH HEIGHT CHANNELS IMAGE.png…");

async function read(image: string): Promise<{ texels?: string; refusal?: string }> {
  try {
    const bytes = new Uint8Array(readFileSync(image));
    const shape = {
      width: Number(width),
      height: Number(height),
      channels: channels === "1" ? 1 : 4,
    } as const;
    const texels = await readPng(bytes, shape, "image");
    return { texels: Buffer.from(texels).toString("base64") };
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    return { refusal: error.finding };
  }
}

process.stdout.write(JSON.stringify(await Promise.all(images.map(read))));
