/** FLIP of two pictures, as nodes; `flip-kernels.ts` names the paper. */
import { abs, clamp, dot, float, length, max, pow, select, step, vec2, vec3, vec4 } from "three/tsl";
import type { Node } from "three/webgpu";
import type { ColourKernels, FeatureKernels, Taps } from "./flip-kernels.js";

/** A picture's texel at some offset in pixels, edges repeated. */
export type At = (x: number, y: number) => Node<"vec4">;

// Linear Rec.709 to XYZ, and D65: FLIP's own numbers.
const XYZ = [
  [10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
  [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
  [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382],
] as const;
const RGB = [
  [3.241003275, -1.537398934, -0.498615861],
  [-0.969224334, 1.875930071, 0.041554224],
  [0.055639423, -0.204011202, 1.057148933],
] as const;
const WHITE = XYZ.map((row) => row[0] + row[1] + row[2]) as [number, number, number];
/** Hunt-adjusted HyAB distance of green and blue, the farthest pair of an sRGB display, to the power of 0.7. */
const LARGEST_DISTANCE = 41.276;
const COLOUR_EXPONENT = 0.7;
const FEATURE_EXPONENT = 0.5;
/** Distances below 0.4 of the largest are spread over 0.95 of the scale. */
const [KNEE, KNEE_VALUE] = [0.4, 0.95];

type Rows = readonly (readonly [number, number, number])[];
const times = (rows: Rows, v: Node<"vec3">): Node<"vec3"> =>
  vec3(...(rows.map((row) => dot(vec3(...row), v)) as [Node<"float">, Node<"float">, Node<"float">]));

/** Linear display values to lightness, red-green and blue-yellow, linear in each. */
export function opponent(linear: Node<"vec3">): Node<"vec3"> {
  const xyz = times(XYZ, linear).div(vec3(...WHITE));
  return vec3(xyz.y.mul(116).sub(16), xyz.x.sub(xyz.y).mul(500), xyz.y.sub(xyz.z).mul(200));
}

/** Filters along a row: four numbers, of which the last two are parts of blue-yellow. */
export function colourRow(at: At, { radius, taps }: ColourKernels): Node<"vec4"> {
  return weighted(radius, (i) => at(i - radius, 0).xyzz.mul(weights(taps, i)));
}

/** Filters the same along a column, and adds up what belongs together: opponent colours. */
export function colourColumn(at: At, { radius, taps, shares }: ColourKernels): Node<"vec3"> {
  const all = weighted(radius, (i) => at(0, i - radius).mul(weights(taps, i)));
  return vec3(all.x, all.y, all.z.mul(shares[0]).add(all.w.mul(shares[1])));
}

/** Of the lightness along a row: bell, slope and curvature. */
export function featureRow(at: At, { radius, taps }: FeatureKernels): Node<"vec4"> {
  const lightness = (i: number): Node<"float"> =>
    at(i - radius, 0)
      .x.add(16)
      .div(116);
  return weighted(radius, (i) => vec4(vec3(...three(taps, i)).mul(lightness(i)), 1 / (2 * radius + 1)));
}

/** How strong an edge and a point are here. */
export function featureColumn(at: At, { radius, taps }: FeatureKernels): Node<"vec2"> {
  const [bell, slope, curvature] = taps;
  // Across: slope and curvature of rows under a bell of columns; down: the other way round.
  const all = weighted(radius, (i) => {
    const row = at(0, i - radius);
    return vec4(row.yz.mul(bell[i] ?? 0), row.xx.mul(vec2(slope[i] ?? 0, curvature[i] ?? 0)));
  });
  return vec2(length(all.xz), length(all.yw));
}

/** FLIP's error of one pixel, in [0, 1], from both sides' filtered colours and features. */
export function flipError(
  colours: readonly [Node<"vec3">, Node<"vec3">],
  features: readonly [Node<"vec2">, Node<"vec2">],
): Node<"float"> {
  const [one, other] = colours.map(huntLab) as [Node<"vec3">, Node<"vec3">];
  const apart = one.sub(other);
  const distance = pow(abs(apart.x).add(length(apart.yz)), float(COLOUR_EXPONENT));
  const knee = KNEE * LARGEST_DISTANCE;
  const below = distance.mul(KNEE_VALUE / knee);
  const above = distance
    .sub(knee)
    .mul((1 - KNEE_VALUE) / (LARGEST_DISTANCE - knee))
    .add(KNEE_VALUE);
  const colour = select(distance.lessThan(knee), below, above);
  const change = abs(features[0].sub(features[1]));
  const feature = pow(max(change.x, change.y).mul(Math.SQRT1_2), float(FEATURE_EXPONENT));
  return pow(clamp(colour, 0, 1), clamp(float(1).sub(feature), 0, 1));
}

/** CIELAB of filtered colours that a display can show, with chroma that counts less in the dark (Hunt). */
function huntLab(yCxCz: Node<"vec3">): Node<"vec3"> {
  const y = yCxCz.x.add(16).div(116);
  const xyz = vec3(yCxCz.y.div(500).add(y), y, y.sub(yCxCz.z.div(200))).mul(vec3(...WHITE));
  const shown = clamp(times(RGB, xyz), 0, 1);
  const relative = times(XYZ, shown).div(vec3(...WHITE));
  const bend = (6 / 29) ** 3;
  const root = pow(max(relative, bend), vec3(1 / 3));
  const line = relative.mul((29 / 6) ** 2 / 3).add(4 / 29);
  const f = line.add(root.sub(line).mul(step(vec3(bend), relative)));
  const lightness = f.y.mul(116).sub(16);
  return vec3(
    lightness,
    f.x.sub(f.y).mul(500).mul(lightness).mul(0.01),
    f.y.sub(f.z).mul(200).mul(lightness).mul(0.01),
  );
}

function weighted(radius: number, term: (index: number) => Node<"vec4">): Node<"vec4"> {
  let sum: Node<"vec4"> = vec4(0);
  for (let i = 0; i <= 2 * radius; i += 1) sum = sum.add(term(i));
  return sum;
}

function weights(taps: readonly [Taps, Taps, Taps, Taps], i: number): Node<"vec4"> {
  return vec4(...(taps.map((row) => row[i] ?? 0) as [number, number, number, number]));
}

function three(taps: readonly [Taps, Taps, Taps], i: number): [number, number, number] {
  return taps.map((row) => row[i] ?? 0) as [number, number, number];
}
