/**
 * Writes all that a field's shader is, for whoever runs it outside of a browser.
 *
 *     node print-shader.js FIELD LANGUAGE OUT [MAX_UNIFORM_BYTES]
 *
 * `OUT/shader.LANGUAGE` is the text, `OUT/NAME.bin` what to bind as NAME (little-endian), `OUT/shader.json` the rest;
 * that is printed too.
 */
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import {
  type Field,
  fieldShader,
  readField,
  readFieldBin,
  type ShaderLanguage,
  WEBGPU_LIMITS,
} from "@irradia/runtime";
import { ZSTDDecoder } from "zstddec";

async function readFile(path: string): Promise<Field> {
  const bytes = new Uint8Array(readFileSync(path));
  if (path.endsWith(".bin")) return readFieldBin(bytes, path);
  const zstd = new ZSTDDecoder();
  await zstd.init();
  return readField(bytes, { unzstd: (packed, size) => zstd.decode(packed, size) });
}

function raw(data: ArrayBufferView): Uint8Array {
  return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
}

async function print(
  path: string,
  language: ShaderLanguage,
  out: string,
  maxUniformBytes: number,
): Promise<void> {
  const shader = fieldShader(await readFile(path), { ...WEBGPU_LIMITS, maxUniformBytes });
  mkdirSync(out, { recursive: true });
  writeFileSync(join(out, `shader.${language}`), shader.text(language));
  const textures = shader.textures.map(({ name, plan, access, data }) => {
    writeFileSync(join(out, `${name}.bin`), raw(data));
    return { name, access, file: `${name}.bin`, ...plan };
  });
  const uniforms = shader.uniforms.map(({ name, values }) => {
    writeFileSync(join(out, `${name}.bin`), raw(values));
    return { name, file: `${name}.bin`, vec4s: values.length / 4 };
  });
  const { entry, inputs, quantity, cost, views } = shader;
  const json = JSON.stringify({ entry, inputs, quantity, cost, views, textures, uniforms }, null, 1);
  writeFileSync(join(out, "shader.json"), json);
  console.log(json);
}

const [path = "", language = "wgsl", out = ".", maxUniformBytes = "65536"] = process.argv.slice(2);
await print(path, language as ShaderLanguage, out, Number(maxUniformBytes));
