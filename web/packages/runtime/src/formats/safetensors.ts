/**
 * The safetensors container: a length, a JSON header, the tensors' bytes.
 *
 * As in the reference implementation (Hugging Face, safetensors) tensors must tile the data exactly: what
 * overlaps, leaves a gap or lies outside is refused.
 */
import { ByteReader } from "../bytes.js";
import { expect } from "../errors.js";
import { type JsonView, parseJson } from "../json.js";
import { product } from "../numbers.js";

const TYPE_BYTES = { F32: 4, F16: 2, I8: 1, U8: 1 } as const;
const MAX_HEADER_BYTES = 1 << 24;
const MAX_AXES = 8;

/** Types of numbers that fields are made of. */
export type NumberType = keyof typeof TYPE_BYTES;

/** A named piece of the file; `bytes` is a view of it, little-endian. */
export interface RawTensor {
  readonly type: NumberType;
  readonly shape: readonly number[];
  readonly bytes: Uint8Array;
}

/** What such a file holds. */
export interface SafeTensors {
  /** Strings by key. */
  readonly metadata: ReadonlyMap<string, string>;
  readonly tensors: ReadonlyMap<string, RawTensor>;
}

/** Takes a file apart; nothing is copied. */
export function readSafeTensors(bytes: Uint8Array, where: string): SafeTensors {
  const file = new ByteReader(bytes, where);
  const headerBytes = file.u64(0);
  expect(
    headerBytes <= MAX_HEADER_BYTES,
    `expected safetensors, found a header of ${headerBytes} bytes`,
    where,
  );
  const header = parseJson(file.slice(8, headerBytes), where);
  const data = file.slice(8 + headerBytes, file.length - 8 - headerBytes);
  const names = header.keys.filter((key) => key !== "__metadata__");
  const places = names.map((name) => placeOf(header.object(name), name));
  expectTiling(places, data.length, where);
  const tensors = places.map(({ name, type, shape, begin, end }) => {
    return [name, { type, shape, bytes: data.subarray(begin, end) }] as const;
  });
  return { metadata: metadataOf(header), tensors: new Map(tensors) };
}

interface Place {
  readonly name: string;
  readonly type: NumberType;
  readonly shape: readonly number[];
  readonly begin: number;
  readonly end: number;
}

function placeOf(entry: JsonView, name: string): Place {
  entry.allow(["dtype", "shape", "data_offsets"]);
  const type = entry.choice("dtype", Object.keys(TYPE_BYTES) as NumberType[]);
  const shape = entry.list("shape").map(Number);
  const sized = shape.length <= MAX_AXES && shape.every((n) => Number.isSafeInteger(n) && n >= 0);
  expect(sized, "expected a shape of whole numbers", entry.at("shape"));
  const [begin, end] = entry.numbers("data_offsets", 2) as [number, number];
  const nBytes = product(shape) * TYPE_BYTES[type];
  const fits = Number.isSafeInteger(begin) && begin >= 0 && end - begin === nBytes;
  expect(fits, `expected ${nBytes} bytes, found ${begin} to ${end}`, entry.at("data_offsets"));
  return { name, type, shape, begin, end };
}

function expectTiling(places: readonly Place[], nBytes: number, where: string): void {
  let next = 0;
  for (const { name, begin, end } of [...places].sort((a, b) => a.begin - b.begin || a.end - b.end)) {
    expect(begin === next, `expected '${name}' at ${next}, found it at ${begin}`, where);
    next = end;
  }
  expect(next === nBytes, `expected ${next} bytes of tensors, found ${nBytes}`, where);
}

function metadataOf(header: JsonView): Map<string, string> {
  const metadata = header.optional("__metadata__");
  return new Map(metadata?.keys.map((key) => [key, metadata.string(key)]));
}
