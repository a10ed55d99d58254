/**
 * Writes all that a field's shader is, for whoever runs it outside of a browser.
 *
 *     node print-shader.js FIELD LANGUAGE OUT [MAX_UNIFORM_BYTES [PRECISION]]
 *
 * LANGUAGE is wgsl, glsl, hlsl or msl. `OUT/shader.LANGUAGE` is the text, `OUT/NAME.bin` what to bind as NAME (little-endian), `OUT/shader.json` the rest;
 * that is printed too. PRECISION is float or half; with half floats WGSL begins with its directive.
 */
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { join, parse } from "node:path";
import { fileURLToPath } from "node:url";
import {
  directives,
  type Field,
  fieldShader,
  PIECES,
  type PieceLanguage,
  type Precision,
  readField,
  readFieldBin,
  WEBGPU_LIMITS,
} from "@irradia/runtime";
import { ZSTDDecoder } from "zstddec";

const SHADERS = fileURLToPath(new URL("../../../shaders", import.meta.url));

async function readFile(path: string): Promise<Field> {
  const bytes = new Uint8Array(readFileSync(path));
  if (path.endsWith(".bin")) return readFieldBin(bytes, path);
  const zstd = new ZSTDDecoder();
  await zstd.init();
  return readField(bytes, { unzstd: (packed, size) => zstd.decode(packed, size) });
}

/** Texts of a language that the runtime doesn't bundle; gives what comes before all pieces. */
function addPieces(language: PieceLanguage): string {
  if (language === "wgsl" || language === "glsl") return "";
  let helpers = "";
  for (const file of readdirSync(join(SHADERS, language))) {
    const text = readFileSync(join(SHADERS, language, file), "utf8");
    const { name } = parse(file);
    const piece = PIECES[name];
    if (name === "helpers") helpers = text;
    else if (piece) Object.assign(piece, { [language]: text });
  }
  return helpers;
}

function raw(data: ArrayBufferView): Uint8Array {
  return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
}

async function print(
  path: string,
  language: PieceLanguage,
  out: string,
  maxUniformBytes: number,
  precision: Precision,
): Promise<void> {
  const field = await readFile(path);
  const shader = fieldShader(field, { ...WEBGPU_LIMITS, maxUniformBytes }, { precision });
  mkdirSync(out, { recursive: true });
  const helpers = addPieces(language);
  const before = language === "wgsl" ? directives(shader) : helpers;
  writeFileSync(join(out, `shader.${language}`), before + shader.text(language as "wgsl"));
  const textures = shader.textures.map(({ name, plan, access, data }) => {
    writeFileSync(join(out, `${name}.bin`), raw(data));
    return { name, access, file: `${name}.bin`, ...plan };
  });
  const uniforms = shader.uniforms.map(({ name, values }) => {
    writeFileSync(join(out, `${name}.bin`), raw(values));
    return { name, file: `${name}.bin`, vec4s: values.length / 4 };
  });
  const { entry, inputs, requires = [], quantity, cost, views } = shader;
  const json = JSON.stringify(
    { entry, inputs, requires, quantity, cost, views, textures, uniforms },
    null,
    1,
  );
  writeFileSync(join(out, "shader.json"), json);
  console.log(json);
}

const [path = "", language = "wgsl", out = ".", maxUniformBytes = "65536", precision = "float"] =
  process.argv.slice(2);
await print(path, language as PieceLanguage, out, Number(maxUniformBytes), precision as Precision);
