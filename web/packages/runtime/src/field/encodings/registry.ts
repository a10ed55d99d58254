/** Encodings by name. A new one is a class in a file of its own, and a line here. */
import { expect } from "../../errors.js";
import type { JsonView } from "../../json.js";
import type { Encoding } from "../encoding.js";
import { Composite } from "./composite.js";
import { Frequency } from "./frequency.js";
import { HashGrid } from "./hash-grid.js";
import { Identity } from "./identity.js";
import { OneBlob } from "./one-blob.js";
import { SphericalHarmonics } from "./spherical-harmonics.js";
import { TriPlane } from "./tri-plane.js";

/** More would be damage: the sizes of all parts are added up before anything is read. */
const MAX_PARTS = 64;

const SIMPLE = [HashGrid, TriPlane, Frequency, OneBlob, SphericalHarmonics, Identity] as const;

/** The names of all encodings. */
export const ENCODING_TYPES: readonly string[] = [...SIMPLE.map(({ type }) => type), Composite.type];

/** Makes an encoding from its spec; fields that are left out have their defaults. */
export function readEncoding(spec: JsonView): Encoding {
  const type = spec.choice("type", ENCODING_TYPES);
  if (type === Composite.type) return readComposite(spec);
  const found = SIMPLE.find((encoding) => encoding.type === type);
  expect(found !== undefined, `no encoding '${type}'`, spec.pointer);
  return found.read(spec);
}

function readComposite(spec: JsonView): Composite {
  spec.allow(["type", "parts"]);
  if (!spec.has("parts")) return new Composite([new Identity()]);
  const parts = spec.objects("parts");
  const fits = parts.length >= 1 && parts.length <= MAX_PARTS;
  expect(fits, `expected 1 to ${MAX_PARTS} parts, found ${parts.length}`, spec.at("parts"));
  return new Composite(parts.map(readEncoding));
}
