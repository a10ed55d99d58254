/**
 * Radiance .hdr, read strictly: three.js' reader takes files that were cut short, and divides by 255 where
 * everyone else divides by 256.
 */
import { expect } from "@irradia/runtime";

export interface RadiancePicture {
  readonly width: number;
  readonly height: number;
  /** Linear RGBA, top row first; alpha is 1. */
  readonly linear: Float32Array;
}

const MOST_PIXELS = 2 ** 27;
/** Where rows were packed by runs, and how long a row may then be. */
const [PACKED_MARK, SHORTEST, LONGEST] = [2, 8, 0x7fff];
const LONGEST_RUN = 127;
const CUT = "The file is damaged or was cut short.";

/**
 * @param where the file's name, for errors
 * @throws InputError where it isn't whole, or its rows don't run from the top left
 */
export function readRadianceHdr(bytes: Uint8Array, where: string): RadiancePicture {
  const { width, height, end, factor } = readHeader(bytes, where);
  const isPossible = bytes.length - end >= height * leastBytesARow(width);
  expect(isPossible, "expected more pixels, found the end", where, CUT); // before so much memory is taken
  const linear = new Float32Array(4 * width * height);
  const row = new Uint8Array(4 * width);
  let at = end;
  for (let y = 0; y < height; y += 1) {
    at = readRow(bytes, at, row, width, where);
    for (let x = 0; x < width; x += 1) decode(row, x, width, factor, linear, 4 * (y * width + x));
  }
  return { width, height, linear };
}

function readHeader(
  bytes: Uint8Array,
  where: string,
): { width: number; height: number; end: number; factor: number } {
  const text = new TextDecoder("latin1").decode(bytes.subarray(0, 65536));
  expect(/^#\?(RADIANCE|RGBE)/.test(text), "expected a Radiance picture, found other bytes", where, CUT);
  const size = /\n\n-Y (\d+) \+X (\d+)\n/.exec(text);
  expect(size !== null, "expected rows from the top left, '-Y height +X width'", where, CUT);
  const [height, width] = [Number(size[1]), Number(size[2])];
  const isSized = width > 0 && height > 0 && width * height <= MOST_PIXELS;
  expect(isSized, `expected a picture, found ${width} × ${height} pixels`, where);
  const exposures = [...text.slice(0, size.index).matchAll(/\nEXPOSURE=\s*([\d.eE+-]+)/g)];
  const factor = exposures.reduce((product, [, value]) => product / Number(value), 1);
  expect(factor > 0 && Number.isFinite(factor), "expected exposures above 0", where);
  return { width, height, end: size.index + size[0].length, factor };
}

/** Of one colour alone: four planes of the longest runs that there are. */
function leastBytesARow(width: number): number {
  const isPackable = width >= SHORTEST && width <= LONGEST;
  return isPackable ? 4 + 4 * 2 * Math.ceil(width / LONGEST_RUN) : 4 * width;
}

/** Rows in four planes: red, green, blue, exponents. */
function readRow(bytes: Uint8Array, from: number, row: Uint8Array, width: number, where: string): number {
  const isPacked = bytes[from] === PACKED_MARK && bytes[from + 1] === PACKED_MARK && width >= SHORTEST;
  if (isPacked && width <= LONGEST && ((bytes[from + 2] ?? 255) & 0x80) === 0) {
    return readRuns(bytes, from + 4, row, where);
  }
  expect(from + 4 * width <= bytes.length, "expected more pixels, found the end", where, CUT);
  for (let x = 0; x < width; x += 1) {
    for (let plane = 0; plane < 4; plane += 1) row[plane * width + x] = bytes[from + 4 * x + plane] ?? 0;
  }
  return from + 4 * width;
}

function readRuns(bytes: Uint8Array, from: number, row: Uint8Array, where: string): number {
  let at = from;
  for (let to = 0; to < row.length; ) {
    const code = bytes[at] ?? 0;
    const [isRun, length] = code > 128 ? [true, code - 128] : [false, code];
    at += 1;
    const isWhole = length > 0 && to + length <= row.length && at + (isRun ? 1 : length) <= bytes.length;
    expect(isWhole, "expected more pixels, found the end", where, CUT);
    if (isRun) row.fill(bytes[at] ?? 0, to, to + length);
    else row.set(bytes.subarray(at, at + length), to);
    at += isRun ? 1 : length;
    to += length;
  }
  return at;
}

function decode(
  row: Uint8Array,
  x: number,
  width: number,
  factor: number,
  linear: Float32Array,
  to: number,
): void {
  const exponent = row[3 * width + x] ?? 0;
  const scale = exponent === 0 ? 0 : factor * 2 ** (exponent - 136);
  for (let channel = 0; channel < 3; channel += 1) {
    linear[to + channel] = (row[channel * width + x] ?? 0) * scale;
  }
  linear[to + 3] = 1;
}
