/** Fields as safetensors, packed or not; docs/field-files.md describes the file. */
import { asFloat32, asUint16 } from "../bytes.js";
import { expect } from "../errors.js";
import { expectTensors, type Field } from "../field/field.js";
import { type FieldSpec, readFrame, readSpec, tensorShapes } from "../field/spec.js";
import type { Codes, Tensor } from "../field/tensor.js";
import { type JsonView, parseJson } from "../json.js";
import { expectFinite, expectFiniteHalves } from "../numbers.js";
import { type RawTensor, readSafeTensors } from "./safetensors.js";
import { isZstd, type UnpackOptions, unpackFrame } from "./zstd.js";

const KEY = "irradia.field";
const VERSION = 1;
const MAX_BLOCK = 2 ** 32;

export interface ReadFieldOptions extends UnpackOptions {
  /** The file's name, for errors. */
  readonly where?: string | undefined;
}

/**
 * Reads a `.safetensors` of ours, or a `.safetensors.zst`; it is told by its first bytes.
 *
 * The field's weights are views of `bytes` where they lie on even addresses, so don't change those.
 *
 * @throws InputError where the file is cut short, damaged, of another version, or no field of ours
 */
export function readField(bytes: Uint8Array, options: ReadFieldOptions = {}): Field {
  const { where = "field" } = options;
  const plain = isZstd(bytes) ? unpackFrame(bytes, where, options) : bytes;
  const { metadata, tensors } = readSafeTensors(plain, where);
  const text = metadata.get(KEY);
  expect(text !== undefined, `expected a field, found safetensors without '${KEY}'`, where);
  const about = parseJson(new TextEncoder().encode(text), `${where}: ${KEY}`);
  about.allow(["version", "spec", "frame", "quantised", "provenance"]);
  about.integer("version", VERSION, VERSION);
  const spec = readSpec(about.object("spec"));
  const field: Field = {
    spec,
    frame: readFrame(about.object("frame")),
    tensors: readTensors(spec, tensors, about.object("quantised"), where),
    provenance: about.object("provenance").plain(),
  };
  expectTensors(field, where);
  return field;
}

/** Every tensor of the spec, and nothing else. */
function readTensors(
  spec: FieldSpec,
  stored: ReadonlyMap<string, RawTensor>,
  quantised: JsonView,
  where: string,
): Map<string, Tensor> {
  const shapes = tensorShapes(spec);
  quantised.allow([...shapes.keys()]);
  const left = new Map(stored);
  const take = (name: string): RawTensor => {
    const tensor = left.get(name);
    expect(tensor !== undefined, `the tensor '${name}' is missing`, where);
    left.delete(name);
    return tensor;
  };
  const tensors = [...shapes].map(([name, shape]) => {
    const at = `${where}: ${name}`;
    if (!quantised.has(name)) return [name, plainTensor(take(name), at)] as const;
    const codes = readCodes(quantised.object(name), take(`${name}.codes`), take(`${name}.scales`), shape, at);
    return [name, { shape, stored: codes }] as const;
  });
  const extra = left.keys().next();
  expect(extra.done === true, `unknown tensor '${extra.value}'`, where);
  return new Map(tensors);
}

function plainTensor({ type, shape, bytes }: RawTensor, where: string): Tensor {
  expect(type === "F16" || type === "F32", `expected halves or floats, found ${type}`, where);
  if (type === "F32") {
    const values = asFloat32(bytes);
    expectFinite(values, where);
    return { shape, stored: { kind: "float", values } };
  }
  const bits = asUint16(bytes);
  expectFiniteHalves(bits, where);
  return { shape, stored: { kind: "half", bits } };
}

function readCodes(
  entry: JsonView,
  codes: RawTensor,
  scales: RawTensor,
  shape: readonly number[],
  where: string,
): Codes {
  const bits = entry.integer("bits", 4, 8);
  expect(bits === 4 || bits === 8, `expected 4 or 8 bits, found ${bits}`, entry.at("bits"));
  const wanted = bits === 8 ? "I8" : "U8";
  expect(codes.type === wanted, `expected codes of ${wanted}, found ${codes.type}`, where);
  const isFlat = scales.type === "F16" && scales.shape.length === 1;
  expect(isFlat, `expected a row of half scales, found ${scales.type} (${scales.shape})`, where);
  // Four bits are packed flat; eight keep the tensor's shape.
  const codesShape = bits === 8 ? shape : [codes.bytes.length];
  expect(
    String(codes.shape) === String(codesShape),
    `expected codes (${codesShape}), found (${codes.shape})`,
    where,
  );
  const halves = asUint16(scales.bytes);
  expectFiniteHalves(halves, where);
  const block = entry.integer("block", 1, MAX_BLOCK);
  return { kind: "codes", bits, block, codes: codes.bytes, scales: halves };
}
