/**
 * The weight file of the Unity project Neural Irradiance Cache, `.bin`: a 56-byte header and half floats.
 *
 * It leaves open how it is to be read; this is the one way in which Irradia writes it, which
 * docs/field-files.md spells out. Files by others are converted by `irradia export`, which knows more ways.
 */
import { asUint16, ByteReader } from "../bytes.js";
import { expect } from "../errors.js";
import type { Encoding, Vec3 } from "../field/encoding.js";
import { Frequency } from "../field/encodings/frequency.js";
import { HashGrid } from "../field/encodings/hash-grid.js";
import { Identity } from "../field/encodings/identity.js";
import { TriPlane } from "../field/encodings/tri-plane.js";
import { expectTensors, type Field } from "../field/field.js";
import { expectBox, type FieldSpec, MAX_HIDDEN_LAYERS, MAX_WIDTH } from "../field/spec.js";
import type { Tensor } from "../field/tensor.js";
import { expectFiniteHalves, product, roundHalfEven } from "../numbers.js";

const HEADER_BYTES = 56;
const PADDING = 4; // halves, as a float4 wants them
const FIX = "Give the .bin of a field, not of samples.";
/** Of irradiance, padded or not, and of SH. */
const OUTPUTS = [3, 4, 12, 16];

interface Header {
  readonly encoding: Encoding;
  readonly width: number;
  readonly nHiddenLayers: number;
  readonly min: Vec3;
  readonly max: Vec3;
}

interface Sizes {
  readonly nInputs: number;
  readonly nOutputs: number;
}

/**
 * Reads a field from a `.bin`.
 *
 * @param where the file's name, for errors
 * @throws InputError where it is damaged, or no such field
 */
export function readFieldBin(bytes: Uint8Array, where = "field"): Field {
  const header = readHeader(new ByteReader(bytes, where));
  expect(bytes.length % 2 === 0, `expected half floats, found ${bytes.length} bytes`, where);
  const halves = asUint16(bytes.subarray(HEADER_BYTES));
  const nEncoding = header.encoding.slots.reduce((sum, { shape }) => sum + product(shape), 0);
  expect(halves.length > nEncoding, `expected over ${nEncoding} weights, found ${halves.length}`, where);
  expectFiniteHalves(halves, where);
  const network = halves.subarray(nEncoding);
  const sizes = layerSizes(network.length, header, where);
  const field: Field = {
    spec: specOf(header, sizes),
    frame: { min: header.min, max: header.max, scale: 1, quantity: "full" },
    tensors: new Map([
      ...encodingTensors(header.encoding, halves),
      ...networkTensors(network, header, sizes),
    ]),
    provenance: {},
  };
  expectTensors(field, where);
  return field;
}

function readHeader(file: ByteReader): Header {
  const { where } = file;
  expect(
    file.length >= HEADER_BYTES,
    `expected a header of ${HEADER_BYTES} bytes, found ${file.length}`,
    where,
  );
  const [width, nHiddenLayers] = [file.u32(24), file.u32(28)];
  const sized = width >= 1 && width <= MAX_WIDTH && nHiddenLayers >= 1 && nHiddenLayers <= MAX_HIDDEN_LAYERS;
  expect(sized, `found ${nHiddenLayers} hidden layers of ${width}: this is no field`, where, FIX);
  const corner = (at: number): Vec3 => [file.f32(at), file.f32(at + 4), file.f32(at + 8)];
  const [min, max] = [corner(32), corner(44)];
  expectBox(min, max, where);
  return { encoding: readEncoding(file), width, nHiddenLayers, min, max };
}

/** The encoding of positions; sizes are bounded before anything is multiplied by them. */
function readEncoding(file: ByteReader): Encoding {
  const [kind, a, b, c] = [file.u32(0), file.u32(4), file.u32(8), file.u32(12)];
  const among = (value: number, low: number, high: number, what: string): void =>
    expect(
      value >= low && value <= high,
      `expected ${low} to ${high} ${what}, found ${value}`,
      file.where,
      FIX,
    );
  among(kind, 0, 2, "as encoding");
  if (kind === 2) {
    among(a, 1, 24, "frequencies");
    among(c, 0, 1, "as identity");
    return new Frequency({ nFrequencies: a, includeIdentity: c === 1 });
  }
  if (kind === 1) {
    among(a, 2, 8192, "texels a side");
    among(c, 1, 128, "features a plane");
    return new TriPlane({ resolution: a, nFeatures: c, alignCorners: false });
  }
  among(a, 1, 32, "levels");
  among(c, 1, 16, "features");
  const log2TableSize = Math.log2(b);
  const isTable = Number.isInteger(log2TableSize) && log2TableSize >= 3 && log2TableSize <= 28;
  expect(isTable, `expected tables of a power of two, found ${b}`, file.where, FIX);
  return hashGrid(file, { nLevels: a, log2TableSize, nFeatures: c });
}

function hashGrid(
  file: ByteReader,
  sizes: { nLevels: number; log2TableSize: number; nFeatures: number },
): HashGrid {
  const [low, high] = [file.f32(16), file.f32(20)];
  expect(low >= 2 && low <= high && high <= 2 ** 20, `found resolutions ${low} to ${high}`, file.where, FIX);
  return new HashGrid({
    ...sizes,
    baseResolution: roundHalfEven(low),
    maxResolution: roundHalfEven(high),
    fullLevels: true,
    hashAll: false,
    convention: "tiny-cuda-nn",
    primes: [1, 2654435761, 805459861],
  });
}

/** Inputs and outputs, which the file doesn't state, from its size. Inputs decide where several outputs fit. */
function layerSizes(nHalves: number, header: Header, where: string): Sizes {
  const { width: h, nHiddenLayers, encoding } = header;
  for (const nOutputs of OUTPUTS) {
    const nInputs = (nHalves - nOutputs) / h - 1 - (nHiddenLayers - 1) * (h + 1) - nOutputs;
    const used = encoding.nOutputs + (nOutputs <= PADDING ? 3 : 0);
    if (nInputs === used || nInputs === Math.ceil(used / PADDING) * PADDING) return { nInputs, nOutputs };
  }
  const network = `${nHiddenLayers} hidden layers of ${h} behind ${encoding.nOutputs} features`;
  expect(false, `${nHalves} weights are no network of ${network}`, where, "It is cut short, or no field.");
}

function specOf({ encoding, width, nHiddenLayers }: Header, { nOutputs }: Sizes): FieldSpec {
  const common = { position: encoding, width, nHiddenLayers, activation: "relu" } as const;
  if (nOutputs > PADDING) return { ...common, head: "linear", mode: "sh1" };
  return { ...common, direction: new Identity(), head: "exp", mode: "irradiance" };
}

function encodingTensors(encoding: Encoding, halves: Uint16Array): [string, Tensor][] {
  let first = 0;
  return encoding.slots.map(({ name, shape }) => {
    const bits = halves.subarray(first, first + product(shape));
    first += bits.length;
    return [`position.${name}`, { shape, stored: { kind: "half", bits } }];
  });
}

/** Matrices and biases without their padding, rows of the last in our order of coefficients. */
function networkTensors(network: Uint16Array, header: Header, sizes: Sizes): [string, Tensor][] {
  const isSh = sizes.nOutputs > PADDING;
  const nFeatures = header.encoding.nOutputs + (isSh ? 0 : 3);
  const tensors: [string, Tensor][] = [];
  let first = 0;
  for (let i = 0; i <= header.nHiddenLayers; i++) {
    const isLast = i === header.nHiddenLayers;
    const [nRows, stride] = [isLast ? sizes.nOutputs : header.width, i ? header.width : sizes.nInputs];
    const nColumns = i ? header.width : nFeatures;
    const rows = isLast ? outputRows(isSh) : Array.from({ length: nRows }, (_, row) => row);
    const matrix = network.subarray(first, first + nRows * stride);
    const bias = network.subarray(first + nRows * stride, first + nRows * (stride + 1));
    first += nRows * (stride + 1);
    tensors.push([
      `mlp.${i}.weight`,
      halfTensor([rows.length, nColumns], pick(matrix, stride, rows, nColumns)),
    ]);
    tensors.push([`mlp.${i}.bias`, halfTensor([rows.length], pick(bias, 1, rows, 1))]);
  }
  return tensors;
}

/** The file's row of each output of ours: RGB, or L0, y, z, x of the channels from L0, x, y, z of each. */
function outputRows(isSh: boolean): number[] {
  if (!isSh) return [0, 1, 2];
  return [0, 2, 3, 1].flatMap((coefficient) => [0, 1, 2].map((channel) => 4 * channel + coefficient));
}

function pick(values: Uint16Array, stride: number, rows: readonly number[], nColumns: number): Uint16Array {
  const picked = new Uint16Array(rows.length * nColumns);
  rows.forEach((row, i) => {
    picked.set(values.subarray(row * stride, row * stride + nColumns), i * nColumns);
  });
  return picked;
}

function halfTensor(shape: number[], bits: Uint16Array): Tensor {
  return { shape, stored: { kind: "half", bits } };
}
