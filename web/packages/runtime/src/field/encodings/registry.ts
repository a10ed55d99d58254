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

/** Of a composite. These two bound what a small file can make us build before any weight is looked at. */
const MAX_PARTS = 16;
/** Composites within composites. */
const MAX_NESTING = 3;

const SIMPLE = [HashGrid, TriPlane, Frequency, OneBlob, SphericalHarmonics, Identity] as const;

/** The names of all encodings. */
export const ENCODING_TYPES: readonly string[] = [...SIMPLE.map(({ type }) => type), Composite.type];

/** Makes an encoding from its spec; fields that are left out have their defaults. */
export function readEncoding(spec: JsonView, nesting = 0): Encoding {
  const type = spec.choice("type", ENCODING_TYPES);
  if (type === Composite.type) return readComposite(spec, nesting + 1);
  const found = SIMPLE.find((encoding) => encoding.type === type);
  expect(found !== undefined, `no encoding '${type}'`, spec.pointer);
  return found.read(spec);
}

function readComposite(spec: JsonView, nesting: number): Composite {
  expect(nesting <= MAX_NESTING, `expected composites at most ${MAX_NESTING} deep`, spec.pointer);
  spec.allow(["type", "parts"]);
  if (!spec.has("parts")) return new Composite([new Identity()]);
  const parts = spec.objects("parts");
  const fits = parts.length >= 1 && parts.length <= MAX_PARTS;
  expect(fits, `expected 1 to ${MAX_PARTS} parts, found ${parts.length}`, spec.at("parts"));
  return new Composite(parts.map((part) => readEncoding(part, nesting)));
}
