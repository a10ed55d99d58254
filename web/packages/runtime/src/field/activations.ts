/** Activations of hidden layers, and heads, which make raw outputs light. */
import { clamp } from "../numbers.js";
import type { Activation, Head } from "./spec.js";

type Curve = (z: number) => number;

/** Slope of leaky ReLU below 0. */
const LEAK = 0.01;
/** Raw outputs beyond ± this are clamped before the exponential. */
const EXP_LIMIT = 15;

export const ACTIVATION_CURVES: Readonly<Record<Activation, Curve>> = {
  relu: (z) => Math.max(z, 0),
  leaky_relu: (z) => (z > 0 ? z : LEAK * z),
  silu: (z) => z / (1 + Math.exp(-z)),
  // The tanh form of Hendrycks and Gimpel 2016: shading languages have no error function.
  gelu: (z) => 0.5 * z * (1 + Math.tanh(Math.sqrt(2 / Math.PI) * (z + 0.044715 * z * z * z))),
  // Its frequency is in the first weights.
  sine: Math.sin,
};

export const HEAD_CURVES: Readonly<Record<Head, Curve>> = {
  exp: (z) => Math.exp(clamp(z, -EXP_LIMIT, EXP_LIMIT)),
  softplus: (z) => Math.max(z, 0) + Math.log1p(Math.exp(-Math.abs(z))),
  linear: (z) => z,
};
