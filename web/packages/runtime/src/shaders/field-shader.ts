/** A neural field's light as a shader. */
import { expect } from "../errors.js";
import type { Field } from "../field/field.js";
import { layerShapes } from "../field/spec.js";
import { paddedWidth, placeOf } from "../gpu/constants.js";
import { encodingShader } from "../gpu/encodings/registry.js";
import { type FieldTextures, planFieldTextures } from "../gpu/field-textures.js";
import { type EncodingLeaf, encodingLeaves } from "../gpu/leaves.js";
import { packField, wordsPerTexel } from "../gpu/pack.js";
import type { TextureLimits } from "../gpu/texture.js";
import { composeText, type PieceChoices, type PieceLanguage, type ShaderPart } from "./compose.js";
import type { LightShader, ShaderCost, ShaderTexture, ShaderUniforms } from "./light-shader.js";

const CONSTANTS = "irradia_constants";
const ENCODE: Readonly<Record<PieceLanguage, string>> = {
  wgsl: "fn irradia_encode(unit: vec3f, normal: vec3f)",
  glsl: "void irradia_encode(vec3 unit, vec3 normal)",
  hlsl: "void irradia_encode(float3 unit, float3 normal)",
  msl: "void irradia_encode(metal::float3 unit, metal::float3 normal)",
};
/** Fragment shaders have 16 textures on every device, and engines use some. */
const MAX_TABLES = 8;

/**
 * The light of a surface, volume or SH field; weights are packed here, once.
 *
 * @throws InputError where the field is too large for the device
 */
export function fieldShader(field: Field, limits: TextureLimits): LightShader {
  const plan = planFieldTextures(field, limits);
  const nTables = plan.tables.length;
  expect(
    nTables <= MAX_TABLES,
    `expected at most ${MAX_TABLES} encodings that learn, found ${nTables}`,
    "field",
  );
  const { textures, uniforms } = bindings(field, plan);
  return {
    entry: "irradia_light",
    inputs: ["position", "normal"],
    textures,
    uniforms,
    quantity: field.frame.quantity,
    cost: costOf(field, plan, textures, uniforms),
    views: {
      raw: "irradia_view_raw",
      hidden: "irradia_view_hidden",
      unclamped: "irradia_view_unclamped",
      "unit-position": "irradia_view_position",
    },
    text: (language) => textOf(field, plan, language),
  };
}

interface Bindings {
  readonly textures: readonly ShaderTexture[];
  readonly uniforms: readonly ShaderUniforms[];
}

function bindings(field: Field, plan: FieldTextures): Bindings {
  const packed = packField(field, plan);
  const tables = plan.tables.map(({ texture }, i): ShaderTexture => {
    const data = packed.tables[i] ?? new Uint32Array();
    return { name: `irradia_table${tableSuffix(i)}`, plan: texture, data, access: "load" };
  });
  const { texture } = plan.constants;
  if (!texture) return { textures: tables, uniforms: [{ name: CONSTANTS, values: packed.constants }] };
  const constants: ShaderTexture = { name: CONSTANTS, plan: texture, data: packed.constants, access: "load" };
  return { textures: [...tables, constants], uniforms: [] };
}

/** What a table's names have behind `irradia_table`. */
function tableSuffix(index: number): string {
  return index ? `_${String.fromCharCode("a".charCodeAt(0) + index)}` : "";
}

function textOf(field: Field, plan: FieldTextures, language: PieceLanguage): string {
  const { spec } = field;
  const common: PieceChoices = {
    constants: plan.constants.texture ? "constants-texture" : "constants-uniform",
    width: `width-${paddedWidth(field)}`,
    activation: `activation-${spec.activation.replace("_", "-")}`,
    head: `head-${spec.head}`,
  };
  const leaves = encodingLeaves(spec);
  const encodings = leaves.map(({ encoding, owner }): ShaderPart => {
    const { piece } = encodingShader(encoding);
    const index = plan.tables.findIndex((table) => table.owner === owner);
    const table = plan.tables[index];
    if (!table) return { piece, choices: common };
    const [words, value] = [`words-${wordsPerTexel(table.texture)}`, `value-${table.entry.bits}`];
    return { piece, choices: { ...common, words, value }, table: tableSuffix(index) };
  });
  return composeText(language, [
    ...encodings,
    { text: encodeFunction(leaves, plan, language) },
    { piece: `light-${spec.mode}`, choices: common },
    { piece: "field-views", choices: common },
  ]);
}

/** The one function that is made for each field: a call for each encoding, the same in both languages. */
function encodeFunction(
  leaves: readonly EncodingLeaf[],
  plan: FieldTextures,
  language: PieceLanguage,
): string {
  const calls = leaves.map((leaf, i) => {
    const shader = encodingShader(leaf.encoding);
    const table = plan.tables.findIndex(({ owner }) => owner === leaf.owner);
    const name = shader.function.replace("irradia_table", `irradia_table${tableSuffix(Math.max(table, 0))}`);
    return `${name}(${plan.constants.records[i]}u, ${argumentOf(leaf)});`;
  });
  return `${ENCODE[language]} {\n${calls.join("\n")}\n}`;
}

function argumentOf({ input, isCube }: EncodingLeaf): string {
  if (input === "position") return "unit";
  return isCube ? "normal * 0.5 + 0.5" : "normal";
}

/** As `query_cost` of the Python package counts. */
function costOf(
  { spec }: Field,
  { tables, constants }: FieldTextures,
  textures: readonly ShaderTexture[],
  uniforms: readonly ShaderUniforms[],
): ShaderCost {
  let [flops, fetches] = [spec.width * spec.nHiddenLayers, 0];
  for (const leaf of encodingLeaves(spec)) {
    const place = placeOf(leaf, tables, constants.scalesVec4);
    const cost = encodingShader(leaf.encoding).cost(leaf.encoding, place);
    flops += cost.flops;
    fetches += cost.fetches;
  }
  for (const { nInputs, nOutputs } of layerShapes(spec)) flops += 2 * nOutputs * nInputs + nOutputs;
  if (constants.texture) fetches += constants.scalesVec4;
  const bytes = [
    ...textures.map(({ plan }) => plan.nBytes),
    ...uniforms.map(({ values }) => values.byteLength),
  ];
  return { flops, fetches, bytes: bytes.reduce((sum, each) => sum + each, 0) };
}
