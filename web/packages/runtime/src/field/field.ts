/** A trained field, and a readable evaluation of it: light at any place of a scene. */
import { expect } from "../errors.js";
import type { Encoding, Vec3 } from "./encoding.js";
import { type Layer, perceptron } from "./mlp.js";
import { irradianceOf } from "./sh.js";
import { type FieldFrame, type FieldSpec, layerShapes, nFeatures, tensorShapes, toUnit } from "./spec.js";
import { expectTensor, type Tensor, tensorValues } from "./tensor.js";

/** What files hold, and everything that shows light asks. */
export interface Field {
  readonly spec: FieldSpec;
  readonly frame: FieldFrame;
  /** Exactly those of `tensorShapes(spec)`, in its order. */
  readonly tensors: ReadonlyMap<string, Tensor>;
  /** What the file says of its making; empty where it says nothing. */
  readonly provenance: Readonly<Record<string, unknown>>;
}

/** A tensor by its name in files; an InputError where the field has none. */
export function tensorOf(field: Field, name: string): Tensor {
  const tensor = field.tensors.get(name);
  expect(tensor !== undefined, `the tensor '${name}' is missing`, "field");
  return tensor;
}

/** Refuses tensors that are missing, unknown, or of another shape than the spec's. */
export function expectTensors(field: Field, where: string): void {
  const shapes = tensorShapes(field.spec);
  for (const name of field.tensors.keys()) expect(shapes.has(name), `unknown tensor '${name}'`, where);
  for (const [name, shape] of shapes) {
    const tensor = field.tensors.get(name);
    expect(tensor !== undefined, `the tensor '${name}' is missing`, where);
    expectTensor(tensor, shape, `${where}: ${name}`);
  }
}

/**
 * Evaluates a field on the CPU, as slowly and plainly as the NumPy reference that it agrees with: shaders
 * are held to it. All weights are decoded to floats once, on construction.
 */
export class FieldEvaluator {
  readonly field: Field;
  readonly #layers: readonly Layer[];
  readonly #encodings: readonly LoadedEncoding[];
  readonly #features: Float64Array;

  constructor(field: Field) {
    const values = (name: string): Float32Array => tensorValues(tensorOf(field, name));
    this.field = field;
    this.#layers = layerShapes(field.spec).map((_, i) => ({
      weight: values(`mlp.${i}.weight`),
      bias: values(`mlp.${i}.bias`),
    }));
    this.#encodings = (["position", "direction"] as const).flatMap((owner) => {
      const encoding = field.spec[owner];
      if (!encoding) return [];
      return [{ encoding, tensors: encoding.slots.map((slot) => values(`${owner}.${slot.name}`)) }];
    });
    this.#features = new Float64Array(nFeatures(field.spec));
  }

  /**
   * E in W·m⁻², linear Rec.709, never negative.
   *
   * @param position metres; outside of the field's box it is clamped to it
   * @param normal unit
   */
  irradiance(position: Vec3, normal: Vec3): [number, number, number] {
    if (this.field.spec.mode !== "irradiance") return irradianceOf(this.coefficients(position), normal);
    const [r = 0, g = 0, b = 0] = this.#outputs(position, normal);
    return [Math.max(r, 0), Math.max(g, 0), Math.max(b, 0)];
  }

  /** SH coefficients of radiance, 4 or 9 of three channels, (coefficient, channel) flattened. */
  coefficients(position: Vec3): Float64Array {
    const { mode } = this.field.spec;
    expect(mode !== "irradiance", "this field gives irradiance, not SH coefficients", "field");
    return this.#outputs(position, undefined);
  }

  /** Features that enter the perceptron; for debugging and for shaders' tests. */
  features(position: Vec3, normal?: Vec3): Float64Array {
    const inputs = [toUnit(this.field.frame, position), normal];
    let first = 0;
    this.#encodings.forEach(({ encoding, tensors }, i) => {
      const input = inputs[i];
      expect(input !== undefined, "this field needs a normal", "field");
      encoding.forward(i ? asInput(encoding, input) : input, tensors, this.#features, first);
      first += encoding.nOutputs;
    });
    return this.#features.slice();
  }

  #outputs(position: Vec3, normal: Vec3 | undefined): Float64Array {
    const { spec, frame } = this.field;
    const outputs = perceptron(spec, this.#layers, this.features(position, normal));
    return outputs.map((value) => value * frame.scale);
  }
}

interface LoadedEncoding {
  readonly encoding: Encoding;
  /** One for each of its slots. */
  readonly tensors: readonly Float32Array[];
}

/** A normal as its encoding wants it. */
function asInput(encoding: Encoding, [x, y, z]: Vec3): Vec3 {
  const halved = (v: number): number => Math.fround(Math.fround(Math.fround(v) * 0.5) + 0.5);
  return encoding.domain === "cube" ? [halved(x), halved(y), halved(z)] : [x, y, z];
}
