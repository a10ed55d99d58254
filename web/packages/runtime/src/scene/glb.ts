/** Binary glTF: its JSON, and pieces of its binary chunk. */
import { ByteReader } from "../bytes.js";
import { expect } from "../errors.js";
import { JsonView, parseJson } from "../json.js";

const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BINARY_CHUNK = 0x004e4942;
const MAX_JSON_BYTES = 2 ** 28;

/** The bytes of a buffer view by its index; `where` is who asks. Throws InputError where there are none. */
export type BufferViews = (index: number, where: string) => Uint8Array;

/** A document and its bytes. */
export interface GltfFile {
  readonly json: JsonView;
  readonly views: BufferViews;
}

/**
 * Takes a .glb apart; nothing is copied.
 *
 * @throws InputError where it is damaged, cut short, or not binary glTF 2.0
 */
export function readGlb(bytes: Uint8Array, where = "scene"): GltfFile {
  const whole = new ByteReader(bytes, where);
  const isGlb = whole.length >= 12 && whole.u32(0) === MAGIC && whole.u32(4) === 2;
  expect(isGlb, "expected a .glb of glTF 2.0", where);
  const file = new ByteReader(whole.slice(0, whole.u32(8)), where);
  const jsonBytes = file.u32(12);
  expect(file.u32(16) === JSON_CHUNK, "expected its JSON first", where);
  expect(jsonBytes <= MAX_JSON_BYTES, `expected less JSON than ${jsonBytes} bytes`, where);
  const json = parseJson(file.slice(20, jsonBytes), where);
  const binary = binaryChunk(file, 20 + jsonBytes);
  return { json, views: (index, asker) => bufferView(json, binary, index, asker) };
}

/**
 * A document that another loader parsed and whose buffer views it fetched: `views` hands those out, and
 * `viewsOfLighting` says which they are.
 */
export function gltfFile(json: unknown, views: BufferViews, where = "scene"): GltfFile {
  return { json: JsonView.of(json, where), views };
}

/** The bytes of a view, whose layout is this package's affair. */
function bufferView(json: JsonView, binary: Uint8Array, index: number, asker: string): Uint8Array {
  expect(json.has("bufferViews"), `expected buffer view ${index}, found none`, asker);
  const view = json.element("bufferViews", index);
  view.integer("buffer", 0, 0);
  const buffer = json.element("buffers", 0);
  expect(!buffer.has("uri"), "expected its buffer to be inside the .glb", asker);
  const nBytes = buffer.integer("byteLength", 1, binary.length);
  const data = new ByteReader(binary.subarray(0, nBytes), view.pointer);
  const most = Number.MAX_SAFE_INTEGER;
  return data.slice(view.integer("byteOffset", 0, most, 0), view.integer("byteLength", 1, most));
}

/** The binary chunk that begins at a place; empty where the file ends there. */
function binaryChunk(file: ByteReader, at: number): Uint8Array {
  if (at + 8 > file.length) return new Uint8Array();
  const isBinary = file.u32(at + 4) === BINARY_CHUNK;
  return isBinary ? file.slice(at + 8, file.u32(at)) : new Uint8Array();
}
