/** Fields from files of their own to sources of light. */
import {
  expect,
  type Field,
  fieldShader,
  readField,
  readFieldBin,
  type TextureLimits,
} from "@irradia/runtime";
import { readyUnzstd } from "@irradia/three/webgpu";
import type { Model } from "../scene/model.js";
import { kindOf, type NamedFile } from "./kinds.js";

export interface LoadedField {
  readonly field: Field;
  /** Of its file. */
  readonly bytes: number;
}

/** Reads .safetensors, packed or not, and .bin of our own conventions. */
export async function loadField(file: NamedFile): Promise<LoadedField> {
  const { name, bytes } = file;
  const isBin = kindOf(file) === "field-bin";
  const options = { where: name, ...(isBin ? {} : { unzstd: await readyUnzstd() }) };
  const field = isBin ? readFieldBin(bytes, name) : readField(bytes, options);
  return { field, bytes: bytes.length };
}

/**
 * Makes a field a source of a scene's light.
 *
 * @param id what the source is to be named
 */
export function addField(
  model: Model | undefined,
  { field, bytes }: LoadedField,
  id: string,
  limits: TextureLimits,
): void {
  expect(model !== undefined, "a field lights a scene, and there is none", id, "Drop its scene first.");
  model.light.add(id, fieldShader(field, limits));
  model.fields.set(id, field);
  model.fieldBytes.set(id, bytes);
}
