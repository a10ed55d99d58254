/** The perceptron: matrices with biases, an activation between them, a head after the last. */
import { ACTIVATION_CURVES, HEAD_CURVES } from "./activations.js";
import type { FieldSpec } from "./spec.js";

/** One matrix (out, in), row by row, with its bias (out). */
export interface Layer {
  readonly weight: Float32Array;
  readonly bias: Float32Array;
}

/** Outputs after the head, in units of the frame's scale. */
export function perceptron(spec: FieldSpec, layers: readonly Layer[], features: Float64Array): Float64Array {
  const activation = ACTIVATION_CURVES[spec.activation];
  let values = features;
  layers.forEach((layer, i) => {
    const isLast = i === layers.length - 1;
    values = affine(layer, values).map(isLast ? HEAD_CURVES[spec.head] : activation);
  });
  return values;
}

function affine({ weight, bias }: Layer, inputs: Float64Array): Float64Array {
  const outputs = Float64Array.from(bias);
  for (let row = 0; row < outputs.length; row++) {
    let sum = 0;
    for (let i = 0; i < inputs.length; i++) {
      sum += (weight[row * inputs.length + i] ?? 0) * (inputs[i] ?? 0);
    }
    outputs[row] = (outputs[row] ?? 0) + sum;
  }
  return outputs;
}
