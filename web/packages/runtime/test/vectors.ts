/** The repository's vectors/: field files with questions, and the answers of the NumPy reference. */
import { readdirSync, readFileSync } from "node:fs";
import {
  type Field,
  type ReadFieldOptions,
  readField,
  readFieldBin,
  type Unzstd,
  type Vec3,
} from "@irradia/runtime";
import { ZSTDDecoder } from "zstddec";

const FOLDER = new URL("../../../../vectors/", import.meta.url);

export interface Vector {
  readonly name: string;
  /** Of the field. */
  readonly file: string;
  readonly bytes: Uint8Array;
  readonly scale: number;
  readonly positions: Vec3[];
  readonly normals: Vec3[];
  readonly irradiance: number[][];
  readonly coefficients?: number[][][];
}

/** All of them. */
export function vectors(): Vector[] {
  const files = readdirSync(FOLDER).filter((file) => file.endsWith(".json"));
  return files.sort().map((answers) => {
    const { field: file, ...rest } = JSON.parse(readFileSync(new URL(answers, FOLDER), "utf8"));
    const bytes = new Uint8Array(readFileSync(new URL(file, FOLDER)));
    return { name: answers.replace(/\.json$/, ""), file, bytes, ...rest };
  });
}

/** One of them. */
export function vector(name: string): Vector {
  const found = vectors().find((each) => each.name === name);
  if (!found) throw new Error(`vectors/ has no ${name}`);
  return found;
}

/** zstddec, ready. */
export async function decoder(): Promise<Unzstd> {
  const zstd = new ZSTDDecoder();
  await zstd.init();
  return (packed, nBytes) => zstd.decode(packed, nBytes);
}

/** Reads a field's file by its name's end, as any page would. */
export function readAny(file: string, bytes: Uint8Array, options: ReadFieldOptions): Field {
  return file.endsWith(".bin") ? readFieldBin(bytes, options.where) : readField(bytes, options);
}
