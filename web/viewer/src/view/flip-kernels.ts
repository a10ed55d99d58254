/**
 * The filters of LDR-FLIP: Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", 2020, as
 * rows and columns. All of its kernels are sums of products of a function of x and one of y, so two passes of
 * 21 taps do what the paper writes as one of 441.
 */

/** A 4K display, 0.7 m wide, seen from 0.7 m: FLIP's default. */
const PIXELS_PER_DEGREE = 67;
/** Contrast sensitivity in equation 2: a, b of Gaussians for lightness, red-green, and twice blue-yellow. */
const LIGHTNESS_B = 0.0047;
const RED_GREEN_B = 0.0053;
const BLUE_YELLOW = [
  [34.1, 0.04],
  [13.5, 0.025],
] as const;
/** Width of what counts as an edge, degrees. */
const FEATURE_WIDTH_DEG = 0.082;

/** Weights from −radius to radius. */
export type Taps = readonly number[];

/** Lightness, red-green, and the two parts of blue-yellow; each sums to 1. */
export interface ColourKernels {
  readonly radius: number;
  readonly taps: readonly [Taps, Taps, Taps, Taps];
  /** Shares of the last two in the blue-yellow filter. */
  readonly shares: readonly [number, number];
}

export function colourKernels(): ColourKernels {
  const radius = Math.ceil(3 * Math.sqrt(BLUE_YELLOW[0][1] / (2 * Math.PI ** 2)) * PIXELS_PER_DEGREE);
  const bell = (b: number): number[] =>
    offsets(radius).map((x) => Math.exp((-(Math.PI ** 2) * (x / PIXELS_PER_DEGREE) ** 2) / b));
  const parts = BLUE_YELLOW.map(([a, b]) => a * Math.sqrt(Math.PI / b) * sum(bell(b)) ** 2);
  const [first = 0, second = 0] = parts;
  const unit = (b: number): Taps => normalised(bell(b));
  return {
    radius,
    taps: [unit(LIGHTNESS_B), unit(RED_GREEN_B), unit(BLUE_YELLOW[0][1]), unit(BLUE_YELLOW[1][1])],
    shares: [first / (first + second), second / (first + second)],
  };
}

/** A bell, its slope and its curvature; positive and negative weights of the latter two each sum to ±1. */
export interface FeatureKernels {
  readonly radius: number;
  readonly taps: readonly [bell: Taps, slope: Taps, curvature: Taps];
}

export function featureKernels(): FeatureKernels {
  const deviation = 0.5 * FEATURE_WIDTH_DEG * PIXELS_PER_DEGREE;
  const radius = Math.ceil(3 * deviation);
  const places = offsets(radius);
  const bell = places.map((x) => Math.exp(-(x ** 2) / (2 * deviation ** 2)));
  const slope = places.map((x, i) => -x * (bell[i] ?? 0));
  const curvature = places.map((x, i) => (x ** 2 / deviation ** 2 - 1) * (bell[i] ?? 0));
  return { radius, taps: [normalised(bell), balanced(slope), balanced(curvature)] };
}

function offsets(radius: number): number[] {
  return Array.from({ length: 2 * radius + 1 }, (_, i) => i - radius);
}

function sum(values: readonly number[]): number {
  return values.reduce((total, value) => total + value, 0);
}

function normalised(values: readonly number[]): number[] {
  const total = sum(values);
  return values.map((value) => value / total);
}

function balanced(values: readonly number[]): number[] {
  const above = sum(values.filter((value) => value > 0));
  const below = -sum(values.filter((value) => value < 0));
  return values.map((value) => value / (value > 0 ? above : below));
}
