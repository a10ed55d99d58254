/**
 * What IRRADIA_lighting says on the document: which light there is, and in which buffer views.
 *
 * docs/IRRADIA_lighting/ describes it. Nothing is decoded here, so that a loader which fetches buffer views
 * one by one knows what to fetch. As everywhere in glTF, unknown keys are left alone.
 */
import { expect } from "../errors.js";
import type { Vec3 } from "../field/encoding.js";
import { expectBox, MODES, type Mode, QUANTITIES, type Quantity } from "../field/spec.js";
import type { TexelEncoding } from "../formats/ktx2.js";
import type { JsonView } from "../json.js";
import { isPowerOfTwo } from "../numbers.js";

export const EXTENSION = "IRRADIA_lighting";
const VERSION = 1;
const ENCODINGS = ["rgb9e5", "half"] as const;
const MAX_INDEX = 2 ** 31;

/** One texture of light, or of directions: texels times `scale`. */
export interface MapEntry {
  readonly pointer: string;
  readonly bufferView: number;
  readonly encoding: TexelEncoding;
  /** Power of two. */
  readonly scale: number;
}

/** The lightmap: texels times `scale` are E/π, linear Rec.709. */
export interface LightmapEntry extends MapEntry {
  /** `indirect`: first bounces of lights that shine live are left out. */
  readonly light: Quantity;
  /** Stops: the light times 2^exposure shows well on a display. */
  readonly exposure: number;
  readonly width: number;
  readonly height: number;
  readonly pages: number;
}

/** The maps of each directional mode; docs/directional.md says how they are decoded. */
export const DIRECTIONAL_MAPS = {
  dominant: ["direction"],
  rnm: ["rnm_0", "rnm_1", "rnm_2"],
  sh: ["sh_l0", "sh_x", "sh_y", "sh_z"],
  "mono-sh": ["sh_l0", "sh_direction"],
} as const;
export type DirectionalMode = keyof typeof DIRECTIONAL_MAPS;

export interface DirectionalEntry {
  readonly mode: DirectionalMode;
  /** By name, in the mode's order. */
  readonly maps: ReadonlyMap<string, MapEntry>;
}

/** Where the field's own file lies, and what it says. */
export interface FieldEntry {
  readonly pointer: string;
  readonly mimeType: "application/vnd.safetensors" | "application/zstd";
  readonly bufferView: number;
  readonly mode: Mode;
  readonly light: Quantity;
  /** Box, metres. */
  readonly min: Vec3;
  readonly max: Vec3;
}

/** All light of a document. */
export interface Lighting {
  readonly lightmap?: LightmapEntry;
  /** First bounces alone of the lights in the lightmap, to be added to a field of indirect light; laid out like it. */
  readonly direct?: MapEntry;
  readonly directional?: DirectionalEntry;
  /** Buffer views of PNG images, one a page; docs/shadow_mask.md. */
  readonly shadowMask?: readonly number[];
  /** The same of the texels' validity, which debug views show. */
  readonly validity?: readonly number[];
  /** Its JSON; `readProbes` decodes it. */
  readonly probes?: JsonView;
  readonly field?: FieldEntry;
}

/**
 * Reads the extension of a document.
 *
 * @param document the glTF's JSON
 * @returns undefined where it has none
 * @throws InputError where it is of another version, or damaged
 */
export function readLighting(document: JsonView): Lighting | undefined {
  const extension = document.optional("extensions")?.optional(EXTENSION);
  if (!extension) return undefined;
  extension.integer("version", VERSION, VERSION);
  const [lightmap, directional] = [extension.optional("lightmap"), extension.optional("directional")];
  const direct = extension.optional("direct");
  const [mask, validity] = [extension.optional("shadowMask"), extension.optional("validity")];
  const [probes, field] = [extension.optional("probes"), extension.optional("field")];
  return {
    ...(lightmap && { lightmap: readLightmapEntry(lightmap) }),
    ...(direct && lightmap && { direct: readMapEntry(direct) }),
    ...(directional && lightmap && { directional: readDirectionalEntry(directional) }),
    ...(mask && lightmap && { shadowMask: readImages(mask, lightmap) }),
    ...(validity && lightmap && { validity: readImages(validity, lightmap) }),
    ...(probes && { probes }),
    ...(field && { field: readFieldEntry(field) }),
  };
}

/** All buffer views of a document's light, for loaders that fetch them one by one; those of nodes aside. */
export function viewsOfLighting(lighting: Lighting): number[] {
  const { lightmap, direct, directional, shadowMask = [], validity = [], probes, field } = lighting;
  const maps = [lightmap, direct, field, ...(directional?.maps.values() ?? [])];
  const views = [...maps.flatMap((entry) => entry?.bufferView ?? []), ...shadowMask, ...validity];
  for (const entry of [probes, probes?.optional("octree")]) {
    for (const key of entry?.keys ?? []) {
      const value = entry?.get(key);
      if (typeof value === "object" && value !== null && "bufferView" in value)
        views.push(Number(value.bufferView));
    }
  }
  return [...new Set(views)];
}

/** A buffer view's index, where an entry has one. */
export function viewOf(entry: JsonView): number {
  return entry.integer("bufferView", 0, MAX_INDEX);
}

/** A power of two. */
export function readScale(entry: JsonView): number {
  const scale = entry.number("scale", 1);
  expect(isPowerOfTwo(scale), `expected a power of two, found ${scale}`, entry.at("scale"));
  return scale;
}

function readMapEntry(entry: JsonView): MapEntry {
  return {
    pointer: entry.pointer,
    bufferView: viewOf(entry),
    encoding: entry.choice("encoding", ENCODINGS),
    scale: readScale(entry),
  };
}

function readLightmapEntry(entry: JsonView): LightmapEntry {
  entry.choice("quantity", ["irradiance_over_pi"]);
  entry.choice("mimeType", ["image/ktx2"]);
  return {
    ...readMapEntry(entry),
    light: entry.choice("light", QUANTITIES, "full"),
    exposure: entry.number("exposure", 0),
    width: entry.integer("width", 1, 32768),
    height: entry.integer("height", 1, 32768),
    pages: entry.integer("pages", 1, 2048),
  };
}

function readDirectionalEntry(entry: JsonView): DirectionalEntry {
  const mode = entry.choice("mode", Object.keys(DIRECTIONAL_MAPS) as DirectionalMode[]);
  const maps = entry.object("maps");
  return {
    mode,
    maps: new Map(DIRECTIONAL_MAPS[mode].map((name) => [name, readMapEntry(maps.object(name))])),
  };
}

/** Buffer views of an image for each page of the lightmap. */
function readImages(entry: JsonView, lightmap: JsonView): number[] {
  const pages = entry.objects("pages").map((page) => {
    page.choice("mimeType", ["image/png"]);
    return viewOf(page);
  });
  const wanted = lightmap.integer("pages", 1, 2048);
  expect(pages.length === wanted, `expected ${wanted} pages, found ${pages.length}`, entry.pointer);
  return pages;
}

function readFieldEntry(entry: JsonView): FieldEntry {
  const corner = (key: string): Vec3 => entry.numbers(key, 3).map(Math.fround) as unknown as Vec3;
  const [min, max] = [corner("min"), corner("max")];
  expectBox(min, max, entry.pointer);
  return {
    pointer: entry.pointer,
    mimeType: entry.choice("mimeType", ["application/vnd.safetensors", "application/zstd"]),
    bufferView: viewOf(entry),
    mode: entry.choice("mode", MODES),
    light: entry.choice("light", QUANTITIES),
    min,
    max,
  };
}
