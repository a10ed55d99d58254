/** Light probes of IRRADIA_lighting: arrays in buffer views of their own; docs/probes.md says how to read them. */
import { asFloat32, asUint16, asUint32 } from "../bytes.js";
import { expect } from "../errors.js";
import type { Vec3 } from "../field/encoding.js";
import { QUANTITIES, type Quantity } from "../field/spec.js";
import type { JsonView } from "../json.js";
import { expectFinite, expectFiniteHalves, halfToNumber, product } from "../numbers.js";
import type { BufferViews } from "./glb.js";
import { readScale, viewOf } from "./lighting.js";

/** More probes than this are damage. */
const MAX_PROBES = 2 ** 24;
const MAX_MAP_SIZE = 64;
const MAX_STATE = 2;
const MAX_LEVEL = 15;
/** No probe, at an octree's corner. */
export const NO_PROBE = 0xffffffff;

/** Probe x + shape[0] (y + shape[1] z) stands at origin + spacing (x, y, z). */
export interface ProbeGrid {
  readonly kind: "grid";
  readonly origin: Vec3;
  readonly spacing: Vec3;
  readonly shape: Vec3;
}

/** Leaves of an octree; one of level l has an edge of size / 2^l. */
export interface ProbeOctree {
  readonly kind: "octree";
  readonly origin: Vec3;
  readonly size: number;
  readonly count: number;
  /** By leaf: x, y, z in cells of its own level, and the level. */
  readonly cells: Uint16Array;
  /** By leaf eight probes, or NO_PROBE; bit 0 of the corner's number is +x, bit 1 +y, bit 2 +z. */
  readonly corners: Uint32Array;
}

/** N probes; lengths in metres. */
export interface Probes {
  readonly light: Quantity;
  readonly count: number;
  /** Coefficients times this are radiance. */
  readonly scale: number;
  /** 27 N half floats by their bits: nine coefficients of three channels. */
  readonly coefficients: Uint16Array;
  /** 3 N: where probes stand in their structure. */
  readonly positions: Float32Array;
  /** 3 N: from there to where light was gathered. */
  readonly offsets: Float32Array;
  /** N: 0 valid, 1 filled from neighbours, 2 empty. */
  readonly states: Uint8Array;
  /** N: share of directions in which no back face was seen. */
  readonly validities: Float32Array;
  /** 4 N: coefficients of the sky's visibility. */
  readonly sky: Float32Array;
  /** N: metres at which distances are cut off. */
  readonly reaches: Float32Array;
  /** Octahedral maps of `size` × `size` texels: mean and deviation, in 255ths of the probe's reach. */
  readonly distances: { readonly size: number; readonly texels: Uint8Array };
  /** Absent for loose probes. */
  readonly structure?: ProbeGrid | ProbeOctree;
}

/**
 * Reads the probes of `readLighting(…).probes`.
 *
 * @throws InputError where arrays are missing, of another size, or hold what probes can't
 */
export function readProbes(entry: JsonView, views: BufferViews): Probes {
  const count = entry.integer("count", 1, MAX_PROBES);
  const map = entry.object("distances");
  const size = map.integer("size", 1, MAX_MAP_SIZE);
  const floats = (key: string, width: number): Float32Array => {
    const values = asFloat32(array(entry.object(key), views, 4 * width * count));
    expectFinite(values, entry.at(key));
    return values;
  };
  const coefficients = asUint16(array(entry.object("coefficients"), views, 2 * 27 * count));
  expectFiniteHalves(coefficients, entry.at("coefficients"));
  const states = array(entry.object("states"), views, count);
  expect(
    states.every((state) => state <= MAX_STATE),
    "expected states of 0, 1 and 2",
    entry.at("states"),
  );
  const structure = readStructure(entry, views, count);
  return {
    light: entry.choice("light", QUANTITIES),
    count,
    scale: readScale(entry),
    coefficients,
    positions: floats("positions", 3),
    offsets: floats("offsets", 3),
    states,
    validities: floats("validities", 1),
    sky: floats("sky", 4),
    reaches: floats("reaches", 1),
    distances: { size, texels: array(map, views, 2 * size * size * count) },
    ...(structure && { structure }),
  };
}

/** Coefficients of radiance of a probe, (coefficient, channel) flattened; `irradianceOf` makes E of them. */
export function probeCoefficients(probes: Probes, index: number): Float64Array {
  const halves = probes.coefficients.subarray(27 * index, 27 * (index + 1));
  return Float64Array.from(halves, (bits) => halfToNumber(bits) * probes.scale);
}

function readStructure(
  entry: JsonView,
  views: BufferViews,
  count: number,
): ProbeGrid | ProbeOctree | undefined {
  if (entry.has("grid")) return readGrid(entry.object("grid"), count);
  return entry.has("octree") ? readOctree(entry.object("octree"), views, count) : undefined;
}

function readGrid(grid: JsonView, count: number): ProbeGrid {
  const [spacing, shape] = [vec3(grid, "spacing"), vec3(grid, "shape")];
  const isSized = shape.every((n) => Number.isInteger(n) && n >= 1) && product(shape) === count;
  expect(isSized, `expected a grid of ${count} probes, found ${shape.join(" × ")}`, grid.pointer);
  expect(
    spacing.every((step) => step > 0),
    "expected a spacing above 0",
    grid.at("spacing"),
  );
  return { kind: "grid", origin: vec3(grid, "origin"), spacing, shape };
}

function readOctree(tree: JsonView, views: BufferViews, nProbes: number): ProbeOctree {
  const count = tree.integer("count", 1, MAX_PROBES);
  const size = tree.number("size");
  expect(size > 0, `expected a size above 0, found ${size}`, tree.at("size"));
  const cells = asUint16(array(tree.object("cells"), views, 8 * count));
  const corners = asUint32(array(tree.object("corners"), views, 32 * count));
  const known = corners.every((probe) => probe < nProbes || probe === NO_PROBE);
  expect(known, `expected corners below ${nProbes}`, tree.at("corners"));
  const shallow = cells.every((value, i) => i % 4 < 3 || value <= MAX_LEVEL);
  expect(shallow, `expected levels of 0 to ${MAX_LEVEL}`, tree.at("cells"));
  return { kind: "octree", origin: vec3(tree, "origin"), size, count, cells, corners };
}

function vec3(entry: JsonView, key: string): Vec3 {
  return entry.numbers(key, 3) as unknown as Vec3;
}

/** The bytes of an array, which has a buffer view of its own. */
function array(place: JsonView, views: BufferViews, nBytes: number): Uint8Array {
  const bytes = views(viewOf(place), place.pointer);
  expect(bytes.length === nBytes, `expected ${nBytes} bytes, found ${bytes.length}`, place.pointer);
  return bytes;
}
