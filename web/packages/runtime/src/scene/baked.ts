/** All baked light of a .glb at once. */
import { expect } from "../errors.js";
import type { Field } from "../field/field.js";
import { readField } from "../formats/field-safetensors.js";
import { type LightTexture, readKtx2 } from "../formats/ktx2.js";
import { isZstd, type UnpackOptions } from "../formats/zstd.js";
import { type BufferViews, type GltfFile, readGlb } from "./glb.js";
import {
  type FieldEntry,
  type Lighting,
  type LightmapEntry,
  type MapEntry,
  readLighting,
} from "./lighting.js";
import { type NodeLight, readNodeLight } from "./nodes.js";
import { type Probes, readProbes } from "./probes.js";

export interface ReadBakedOptions extends UnpackOptions {
  /** The file's name, for errors. */
  readonly where?: string | undefined;
}

/** What a baked scene holds; what it doesn't is absent. */
export interface BakedLight {
  /** Scales, exposure, modes: what the document says of the following. */
  readonly lighting: Lighting;
  /** Texels times `lighting.lightmap.scale` are E/π. */
  readonly lightmap?: LightTexture;
  /** First bounces alone; texels times `lighting.direct.scale` are E/π. */
  readonly direct?: LightTexture;
  /** By name; texels times the scale in `lighting.directional.maps`. */
  readonly directional?: ReadonlyMap<string, LightTexture>;
  /** PNG files, one a page. */
  readonly shadowMask?: readonly Uint8Array[];
  /** PNG files, one a page: 0 outside charts, else 1 + 254 times the texel's validity. */
  readonly validity?: readonly Uint8Array[];
  readonly probes?: Probes;
  readonly field?: Field;
  /** By index; only those of which the extension says something. */
  readonly nodes: ReadonlyMap<number, NodeLight>;
}

/**
 * Reads a .glb that `irradia bake` wrote.
 *
 * @returns undefined where the file has no baked light of ours
 * @throws InputError where anything of it is damaged
 */
export function readBakedGlb(bytes: Uint8Array, options: ReadBakedOptions = {}): BakedLight | undefined {
  return readBaked(readGlb(bytes, options.where), options);
}

/** The same behind a loader of one's own, such as GLTFLoader. */
export function readBaked(file: GltfFile, options: UnpackOptions = {}): BakedLight | undefined {
  const lighting = readLighting(file.json);
  if (!lighting) return undefined;
  const { lightmap, direct, directional, shadowMask, validity, probes, field } = lighting;
  const views = file.views;
  return {
    lighting,
    ...(lightmap && { lightmap: readMap(lightmap, lightmap, views, options) }),
    ...(lightmap && direct && { direct: readMap(direct, lightmap, views, options) }),
    ...(lightmap && directional && { directional: readMaps(directional.maps, lightmap, views, options) }),
    ...(shadowMask && { shadowMask: shadowMask.map((view) => views(view, "shadow mask")) }),
    ...(validity && { validity: validity.map((view) => views(view, "validity")) }),
    ...(probes && { probes: readProbes(probes, views) }),
    ...(field && { field: readFieldOf(field, views, options) }),
    nodes: readNodes(file, lightmap),
  };
}

/** A texture of the lightmap's size and layers, in the encoding that its entry says. */
export function readMap(
  entry: MapEntry,
  lightmap: LightmapEntry,
  views: BufferViews,
  options: UnpackOptions,
): LightTexture {
  const texture = readKtx2(views(entry.bufferView, entry.pointer), entry.pointer, options);
  const { width, height, pages } = lightmap;
  const fits = texture.width === width && texture.height === height && texture.layers === pages;
  const found = `${texture.width} × ${texture.height} × ${texture.layers}`;
  expect(fits, `expected ${width} × ${height} × ${pages} texels, found ${found}`, entry.pointer);
  const expected = `expected texels as ${entry.encoding}, found ${texture.encoding}`;
  expect(texture.encoding === entry.encoding, expected, entry.pointer);
  return texture;
}

/** The field's file, if it is what the document says. */
export function readFieldOf(entry: FieldEntry, views: BufferViews, options: UnpackOptions): Field {
  const bytes = views(entry.bufferView, entry.pointer);
  const isPacked = entry.mimeType === "application/zstd";
  const field = readField(bytes, { ...options, where: entry.pointer });
  const { frame, spec } = field;
  const agrees =
    isPacked === isZstd(bytes) &&
    spec.mode === entry.mode &&
    frame.quantity === entry.light &&
    String(frame.min) === String(entry.min) &&
    String(frame.max) === String(entry.max);
  expect(agrees, "what it says of its field isn't what the field's file says", entry.pointer);
  return field;
}

function readMaps(
  maps: ReadonlyMap<string, MapEntry>,
  lightmap: LightmapEntry,
  views: BufferViews,
  options: UnpackOptions,
): Map<string, LightTexture> {
  return new Map([...maps].map(([name, entry]) => [name, readMap(entry, lightmap, views, options)]));
}

function readNodes(file: GltfFile, lightmap: LightmapEntry | undefined): Map<number, NodeLight> {
  const nodes = new Map<number, NodeLight>();
  file.json.objects("nodes").forEach((_, index) => {
    const light = readNodeLight(file, index, lightmap);
    if (light) nodes.set(index, light);
  });
  return nodes;
}
