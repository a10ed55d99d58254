/** A neural field's light as a shader. */
import { expect } from "../errors.js";
import type { Field } from "../field/field.js";
import { layerShapes } from "../field/spec.js";
import { type ConstantsPlan, type Precision, paddedWidth, placeOf } from "../gpu/constants.js";
import { encodingShader } from "../gpu/encodings/registry.js";
import { type FieldTextures, planFieldTextures } from "../gpu/field-textures.js";
import { type EncodingLeaf, encodingLeaves } from "../gpu/leaves.js";
import { packField, wordsPerTexel } from "../gpu/pack.js";
import type { TextureLimits } from "../gpu/texture.js";
import { composeText, type PieceChoices, type PieceLanguage, type ShaderPart } from "./compose.js";
import type { LightShader, ShaderCost, ShaderTexture, ShaderUniforms } from "./light-shader.js";

/** How a field is drawn. */
export interface FieldShaderOptions {
  /**
   * `half`: weights are half floats, and so is what hidden layers hand on; sums and outputs are floats. Light is
   * within 1e-3 of the largest. For WGSL on devices with `shader-f16`, and HLSL and MSL; GLSL ES has no halves.
   * `float`, by default: exact to 1e-5.
   */
  readonly precision?: Precision | undefined;
}

const CONSTANTS = "irradia_constants";
const WEIGHTS = "irradia_weights";
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
 * @throws InputError where the field is too large for the device, or a weight for half precision
 */
export function fieldShader(
  field: Field,
  limits: TextureLimits,
  { precision = "float" }: FieldShaderOptions = {},
): LightShader {
  const plan = planFieldTextures(field, limits, precision);
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
    ...(precision === "half" ? { requires: ["shader-f16"] as const } : {}),
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
  const { texture, weights } = plan.constants;
  const textures = [...tables];
  if (weights && packed.weights)
    textures.push({ name: WEIGHTS, plan: weights, data: packed.weights, access: "load" });
  if (!texture) return { textures, uniforms: [{ name: CONSTANTS, values: packed.constants }] };
  textures.push({ name: CONSTANTS, plan: texture, data: packed.constants, access: "load" });
  return { textures, uniforms: [] };
}

/** What a table's names have behind `irradia_table`. */
function tableSuffix(index: number): string {
  return index ? `_${String.fromCharCode("a".charCodeAt(0) + index)}` : "";
}

function textOf(field: Field, plan: FieldTextures, language: PieceLanguage): string {
  const { spec } = field;
  const isHalf = plan.constants.weights !== undefined;
  expect(
    !isHalf || language !== "glsl",
    "expected WGSL, HLSL or MSL for half precision, found GLSL, whose ES 3.00 has no half floats",
    "field",
    'Take precision "float".',
  );
  const common: PieceChoices = {
    constants: plan.constants.texture ? "constants-texture" : "constants-uniform",
    perceptron: `perceptron-${isHalf ? "half" : "float"}`,
    width: `width-${paddedWidth(field)}`,
    halves: `halves-${paddedWidth(field)}`,
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

/** Each texel of weights once, but for those of a first matrix' padding. */
function weightFetches({ layers, weights }: ConstantsPlan): number {
  if (!weights) return 0;
  return layers.reduce(
    (sum, { nInputs, blocksIn, blocksOut }, i) => sum + ((i ? 4 * blocksIn : nInputs) * blocksOut) / 2,
    0,
  );
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
  fetches += weightFetches(constants);
  const bytes = [
    ...textures.map(({ plan }) => plan.nBytes),
    ...uniforms.map(({ values }) => values.byteLength),
  ];
  return { flops, fetches, bytes: bytes.reduce((sum, each) => sum + each, 0) };
}
