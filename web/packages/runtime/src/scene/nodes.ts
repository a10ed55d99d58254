/** What IRRADIA_lighting says on nodes: which part of the lightmap each primitive reads. */
import { asFloat32, asUint16, ByteReader } from "../bytes.js";
import { expect } from "../errors.js";
import type { JsonView } from "../json.js";
import { expectFinite } from "../numbers.js";
import type { GltfFile } from "./glb.js";
import { EXTENSION, type LightmapEntry } from "./lighting.js";

/** Where an instance's uv lie: page uv = TEXCOORD · scale + offset. */
export interface Rectangle {
  readonly page: number;
  readonly scale: readonly [number, number];
  readonly offset: readonly [number, number];
}

/** What one primitive of a node reads. */
export interface PrimitiveLight {
  /** The TEXCOORD set of its uv. */
  readonly texCoord: number;
  /** One; with EXT_mesh_gpu_instancing one for each instance, undefined for those without a lightmap. */
  readonly rectangles: readonly (Rectangle | undefined)[];
}

export interface NodeLight {
  /** By primitive of the node's mesh; undefined for those without a lightmap. */
  readonly primitives: readonly (PrimitiveLight | undefined)[];
  /** The KHR_lights_punctual light that stood here, whose light is in the map. */
  readonly bakedLight?: number;
  /** The EXT_lights_ies light that stood here, likewise. */
  readonly bakedIesLight?: number;
  /** Channel of the shadow mask for the live light on this node. */
  readonly shadowMaskChannel?: number;
}

const NO_PAGE = 0xffff;
const MAX_INDEX = 2 ** 31;
const FLOAT = 5126;
const UNSIGNED_SHORT = 5123;

/**
 * Reads what a node's extension says.
 *
 * @param node index in the document
 * @param lightmap of the document, by which pages are checked
 * @returns undefined where the node has none
 */
export function readNodeLight(file: GltfFile, node: number, lightmap?: LightmapEntry): NodeLight | undefined {
  const entry = file.json.element("nodes", node).optional("extensions")?.optional(EXTENSION);
  if (!entry) return undefined;
  const primitives = entry.objects("primitives").map((primitive) => {
    return primitive.has("texCoord") ? readPrimitive(file, primitive, lightmap?.pages ?? 0) : undefined;
  });
  const measured = entry.optional("bakedIesLight");
  return {
    primitives,
    ...(entry.has("bakedLight") && { bakedLight: entry.integer("bakedLight", 0, MAX_INDEX) }),
    ...(measured && { bakedIesLight: measured.integer("light", 0, MAX_INDEX) }),
    ...(entry.has("shadowMaskChannel") && { shadowMaskChannel: entry.integer("shadowMaskChannel", 0, 3) }),
  };
}

/** Buffer views of the tables that nodes with instances have, for loaders that fetch views one by one. */
export function viewsOfNodes(document: JsonView): number[] {
  const primitives = document.objects("nodes").flatMap((node) => {
    return node.optional("extensions")?.optional(EXTENSION)?.objects("primitives") ?? [];
  });
  const views = primitives.flatMap((entry) => {
    const tables = ["scaleOffsets", "pages"].filter((key) => entry.has(key));
    return tables.map((key) => {
      return document
        .element("accessors", entry.integer(key, 0, MAX_INDEX))
        .integer("bufferView", 0, MAX_INDEX);
    });
  });
  return [...new Set(views)];
}

function readPrimitive(file: GltfFile, entry: JsonView, nPages: number): PrimitiveLight {
  const texCoord = entry.integer("texCoord", 1, 31);
  expect(nPages > 0, "expected a lightmap on the document", entry.pointer);
  if (entry.has("scaleOffsets")) return { texCoord, rectangles: readTable(file, entry, nPages) };
  const [scaleU, scaleV] = entry.numbers("scale", 2, [1, 1]) as [number, number];
  const [offsetU, offsetV] = entry.numbers("offset", 2, [0, 0]) as [number, number];
  const page = entry.integer("page", 0, nPages - 1);
  return { texCoord, rectangles: [{ page, scale: [scaleU, scaleV], offset: [offsetU, offsetV] }] };
}

function readTable(file: GltfFile, entry: JsonView, nPages: number): (Rectangle | undefined)[] {
  const rows = asFloat32(
    readAccessor(file, entry, "scaleOffsets", { type: "VEC4", componentType: FLOAT, size: 16 }),
  );
  expectFinite(rows, entry.at("scaleOffsets"));
  const count = rows.length / 4;
  const common = entry.has("pages") ? 0 : entry.integer("page", 0, NO_PAGE);
  const pages = entry.has("pages")
    ? asUint16(readAccessor(file, entry, "pages", { type: "SCALAR", componentType: UNSIGNED_SHORT, size: 2 }))
    : new Uint16Array(count).fill(common);
  expect(pages.length === count, `expected ${count} pages, found ${pages.length}`, entry.pointer);
  return Array.from(pages, (page, i) => {
    if (page === NO_PAGE) return undefined;
    expect(page < nPages, `expected pages below ${nPages}, found ${page}`, entry.pointer);
    const [u = 0, v = 0, x = 0, y = 0] = rows.subarray(4 * i, 4 * i + 4);
    return { page, scale: [u, v], offset: [x, y] };
  });
}

interface Elements {
  readonly type: string;
  readonly componentType: number;
  /** Bytes of an element. */
  readonly size: number;
}

/** The bytes of an accessor's elements, one behind another. */
function readAccessor(file: GltfFile, entry: JsonView, key: string, wanted: Elements): Uint8Array {
  const accessor = file.json.element("accessors", entry.integer(key, 0, MAX_INDEX));
  accessor.choice("type", [wanted.type]);
  accessor.integer("componentType", wanted.componentType, wanted.componentType);
  expect(!accessor.has("sparse"), "expected no sparse accessor", accessor.pointer);
  const index = accessor.integer("bufferView", 0, MAX_INDEX);
  const view = new ByteReader(file.views(index, accessor.pointer), accessor.pointer);
  const stride = file.json.element("bufferViews", index).integer("byteStride", wanted.size, 252, wanted.size);
  const first = accessor.integer("byteOffset", 0, view.length, 0);
  const count = accessor.integer("count", 1, Math.floor(view.length / wanted.size));
  const packed = new Uint8Array(count * wanted.size);
  for (let i = 0; i < count; i++) packed.set(view.slice(first + i * stride, wanted.size), i * wanted.size);
  return packed;
}
