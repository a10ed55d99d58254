/**
 * Writes shaders of light with all that they read, for comparison with what Python says of the same files.
 *
 *   node dist/checks/shader-cases.js OUT JOBS.json
 *
 * JOBS.json is a list of {name, file, source}. OUT gets cases.json and the bytes of textures and uniforms.
 */
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import {
  type BakedLight,
  directionalShader,
  directives,
  type Field,
  fieldShader,
  type LightShader,
  lightmapShader,
  type Precision,
  probeShader,
  readBakedGlb,
  readField,
  readFieldBin,
  type ShaderLanguage,
  type TextureLimits,
  WEBGL2_LIMITS,
  withDirect,
} from "@irradia/runtime";
import { ZSTDDecoder } from "zstddec";

type Source = "field" | "lightmap" | "directional" | "probes" | "things" | "direct";

interface Job {
  readonly name: string;
  readonly file: string;
  readonly source: Source;
  /** Constants become a texture where they have more bytes than a device's uniform block takes. */
  readonly maxUniformBytes?: number;
  /** Of a field's perceptron; in half precision there is no GLSL. */
  readonly precision?: Precision;
  /** Lists that are longer than so many rows go on in further layers. */
  readonly maxSize?: number;
}

const HLSL_FOLDER = new URL("../../../shaders/hlsl/", import.meta.url);
const PIECES_MODULE = new URL("../../packages/runtime/dist/shaders/pieces.js", import.meta.url);
/** The runtime bundles WGSL and GLSL alone; `addHlsl` gives it a third language. */
const HLSL = "hlsl" as ShaderLanguage;

const [folder, jobs] = process.argv.slice(2);
if (!folder || !jobs) throw new Error("usage: shader-cases.js OUT JOBS.json");

const zstd = new ZSTDDecoder();
await zstd.init();
const options = { unzstd: (packed: Uint8Array, nBytes: number) => zstd.decode(packed, nBytes) };

mkdirSync(folder, { recursive: true });
await addHlsl();
const cases = (JSON.parse(readFileSync(jobs, "utf8")) as Job[]).map(written);
writeFileSync(path.join(folder, "cases.json"), JSON.stringify(cases));
console.log(JSON.stringify({ cases: cases.length }));

/** A case as JSON, its bytes in files of their own. */
function written(job: Job): object {
  const shader = shaderOf(job);
  const file = (name: string, data: ArrayBufferView): string => {
    const there = `${job.name}.${name}.bin`;
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    writeFileSync(path.join(folder ?? "", there), bytes);
    return there;
  };
  return {
    name: job.name,
    inputs: shader.inputs,
    views: shader.views,
    cost: shader.cost,
    directives: directives(shader),
    texts: {
      wgsl: shader.text("wgsl"),
      glsl: job.precision === "half" ? "" : shader.text("glsl"),
      hlsl: hlslOf(shader, job),
    },
    textures: shader.textures.map(({ name, access, plan, data }) => ({
      name,
      access,
      ...plan,
      file: file(name, data),
    })),
    uniforms: shader.uniforms.map(({ name, values }) => ({
      name,
      nVec4: values.length / 4,
      file: file(name, values),
    })),
  };
}

/** Puts the texts of shaders/hlsl/ beside those that the runtime composes from. */
async function addHlsl(): Promise<void> {
  const { PIECES } = (await import(PIECES_MODULE.href)) as { PIECES: Record<string, object> };
  for (const file of readdirSync(HLSL_FOLDER)) {
    const piece = PIECES[path.basename(file, ".hlsl")];
    if (piece) Object.assign(piece, { hlsl: readFileSync(new URL(file, HLSL_FOLDER), "utf8") });
  }
}

function hlslOf(shader: LightShader, job: Job): string {
  if (job.source === "direct") return ""; // what sums the two is made for WGSL and GLSL alone
  return readFileSync(new URL("helpers.hlsl", HLSL_FOLDER), "utf8") + shader.text(HLSL);
}

function shaderOf({ name, file, source, maxUniformBytes, maxSize, precision }: Job): LightShader {
  const bytes = new Uint8Array(readFileSync(file));
  const limits: TextureLimits = {
    ...WEBGL2_LIMITS,
    ...(maxUniformBytes !== undefined && { maxUniformBytes }),
    ...(maxSize !== undefined && { maxSize }),
  };
  if (source === "field") return fieldShader(fieldOf(file, bytes), limits, { precision });
  const baked = readBakedGlb(bytes, options);
  if (!baked) throw new Error(`${name}: no light in ${file}`);
  return bakedShader(baked, source, limits);
}

function bakedShader(baked: BakedLight, source: Source, limits: TextureLimits): LightShader {
  const { lighting, lightmap, direct, probes, field } = baked;
  if (source === "directional") return directionalShader(baked, limits);
  if (source === "lightmap" && lighting.lightmap && lightmap)
    return lightmapShader(lightmap, lighting.lightmap.scale, "full", limits);
  if (source === "direct" && lighting.direct && direct && field)
    return withDirect(fieldShader(field, limits), direct, lighting.direct.scale, limits);
  if (!probes) throw new Error(`nothing that is ${source}`);
  return probeShader(probes, limits, { lit: source === "things" ? "things" : "surfaces" });
}

function fieldOf(file: string, bytes: Uint8Array): Field {
  return file.endsWith(".bin") ? readFieldBin(bytes) : readField(bytes, options);
}
