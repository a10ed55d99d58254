/** What a field is made of, and what scene it was trained for: all that isn't a weight. */
import { expect } from "../errors.js";
import type { JsonView } from "../json.js";
import { isPowerOfTwo } from "../numbers.js";
import type { Encoding, Vec3 } from "./encoding.js";
import { readEncoding } from "./encodings/registry.js";

export const MODES = ["irradiance", "sh1", "sh2"] as const;
export const HEADS = ["exp", "softplus", "linear"] as const;
export const ACTIVATIONS = ["relu", "leaky_relu", "silu", "gelu", "sine"] as const;
export const QUANTITIES = ["full", "indirect"] as const;

/** What comes out: E in RGB, or SH coefficients of radiance to L1 or L2. */
export type Mode = (typeof MODES)[number];
/** What makes raw outputs light. */
export type Head = (typeof HEADS)[number];
/** Of hidden layers. */
export type Activation = (typeof ACTIVATIONS)[number];
/** `indirect` leaves out the first bounce of lights that an engine draws itself. */
export type Quantity = (typeof QUANTITIES)[number];

/** An architecture: features of position and normal, then a perceptron. */
export interface FieldSpec {
  readonly position: Encoding;
  /** Of the unit normal, its features after those of position; absent in SH modes. */
  readonly direction?: Encoding;
  /** Of each hidden layer. */
  readonly width: number;
  /** So there is a matrix more, each with a bias. */
  readonly nHiddenLayers: number;
  readonly activation: Activation;
  readonly head: Head;
  readonly mode: Mode;
}

/** How a field's numbers relate to a scene. */
export interface FieldFrame {
  /** The box that becomes [0, 1]³, metres, as floats. */
  readonly min: Vec3;
  readonly max: Vec3;
  /** Power of two; outputs times this are E in W·m⁻², or coefficients of radiance. */
  readonly scale: number;
  readonly quantity: Quantity;
}

/** Outputs of the perceptron: RGB, or (coefficient, channel) flattened. */
export const N_OUTPUTS: Readonly<Record<Mode, number>> = { irradiance: 3, sh1: 12, sh2: 27 };

/** Largest perceptron that files may hold. */
export const MAX_WIDTH = 128;
export const MAX_HIDDEN_LAYERS = 6;

/** The shape of a perceptron's matrix. */
export interface LayerShape {
  readonly nOutputs: number;
  readonly nInputs: number;
}

/** Features that enter the perceptron. */
export function nFeatures(spec: FieldSpec): number {
  return spec.position.nOutputs + (spec.direction?.nOutputs ?? 0);
}

/** Each matrix, first to last. */
export function layerShapes(spec: FieldSpec): LayerShape[] {
  const hidden = Array<number>(spec.nHiddenLayers).fill(spec.width);
  const outputs = [...hidden, N_OUTPUTS[spec.mode]];
  return outputs.map((nOutputs, i) => ({ nOutputs, nInputs: outputs[i - 1] ?? nFeatures(spec) }));
}

/** Every tensor's shape by the name that files give it, in order. */
export function tensorShapes(spec: FieldSpec): Map<string, readonly number[]> {
  const shapes = new Map<string, readonly number[]>();
  for (const owner of ["position", "direction"] as const) {
    for (const { name, shape } of spec[owner]?.slots ?? []) shapes.set(`${owner}.${name}`, shape);
  }
  layerShapes(spec).forEach(({ nOutputs, nInputs }, i) => {
    shapes.set(`mlp.${i}.weight`, [nOutputs, nInputs]);
    shapes.set(`mlp.${i}.bias`, [nOutputs]);
  });
  return shapes;
}

/** Reads a spec as `print_spec` prints it; what is left out has its default. */
export function readSpec(json: JsonView): FieldSpec {
  json.allow(["position", "direction", "width", "n_hidden_layers", "activation", "head", "mode"]);
  const hasNormal = json.has("direction") && json.get("direction") !== null;
  const spec: FieldSpec = {
    position: readEncoding(json.object("position")),
    ...(hasNormal && { direction: readEncoding(json.object("direction")) }),
    width: json.integer("width", 1, MAX_WIDTH, 64),
    nHiddenLayers: json.integer("n_hidden_layers", 1, MAX_HIDDEN_LAYERS, 2),
    activation: json.choice("activation", ACTIVATIONS, "relu"),
    head: json.choice("head", HEADS, "exp"),
    mode: json.choice("mode", MODES, "irradiance"),
  };
  const isIrradiance = spec.mode === "irradiance";
  const why = "irradiance needs the normal, and SH coefficients don't depend on it";
  expect(hasNormal === isIrradiance, why, json.pointer);
  expect(
    isIrradiance || spec.head === "linear",
    "SH coefficients have signs: expected head linear",
    json.pointer,
  );
  return spec;
}

/** Reads a frame: its box, scale and quantity. */
export function readFrame(json: JsonView): FieldFrame {
  json.allow(["aabb", "scale", "quantity"]);
  const corners = json.list("aabb").map((corner) => asVec3(corner, json.at("aabb")));
  const [min, max] = corners;
  expect(
    corners.length === 2 && min !== undefined && max !== undefined,
    "expected two corners",
    json.at("aabb"),
  );
  expectBox(min, max, json.at("aabb"));
  const scale = json.number("scale");
  expect(isPowerOfTwo(scale), `expected a power of two, found ${scale}`, json.at("scale"));
  return { min, max, scale, quantity: json.choice("quantity", QUANTITIES) };
}

/** Refuses boxes that are inside out, and corners that no float holds. */
export function expectBox(min: Vec3, max: Vec3, where: string): void {
  const fits = min.every((low, axis) => {
    const high = max[axis] ?? Number.NaN;
    return Number.isFinite(low) && Number.isFinite(high) && low <= high;
  });
  expect(fits, `expected a box, found ${min} to ${max}`, where);
}

/** The box's sides, metres, as floats; flat ones get a little, to divide by. */
export function extentOf({ min, max }: FieldFrame): [number, number, number] {
  const extent = (axis: 0 | 1 | 2): number => Math.max(Math.fround(max[axis] - min[axis]), 1e-12);
  return [extent(0), extent(1), extent(2)];
}

/** A place in metres in [0, 1]³ of the box, as floats compute it; what lies outside is clamped. */
export function toUnit(frame: FieldFrame, position: Vec3): [number, number, number] {
  const extent = extentOf(frame);
  const unit = (axis: 0 | 1 | 2): number => {
    const x = Math.fround(Math.fround(Math.fround(position[axis]) - frame.min[axis]) / extent[axis]);
    return Math.min(Math.max(x, 0), 1);
  };
  return [unit(0), unit(1), unit(2)];
}

function asVec3(value: unknown, where: string): Vec3 {
  const fits = Array.isArray(value) && value.length === 3 && value.every(Number.isFinite);
  expect(fits, "expected three finite numbers", where);
  return value.map((number) => Math.fround(number)) as unknown as Vec3;
}
