/** A small .glb with one of everything that IRRADIA_lighting can hold, made without our exporter. */
import { vector } from "./vectors.js";

export interface Glb {
  // biome-ignore lint/suspicious/noExplicitAny: tests put values there that no type allows
  json: any;
  binary: Uint8Array;
}

export const PAGES = { width: 4, height: 2, pages: 2 };
export const N_PROBES = 6;

/** Collects what buffer views hold, each on a multiple of four bytes. */
class Binary {
  readonly views: { buffer: 0; byteOffset: number; byteLength: number }[] = [];
  readonly #pieces: Uint8Array[] = [];

  /** Adds a view; gives the entry that names it. */
  add(data: ArrayBufferView): { bufferView: number } {
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    const padded = new Uint8Array(Math.ceil(bytes.length / 4) * 4);
    padded.set(bytes);
    this.views.push({ buffer: 0, byteOffset: this.whole().length, byteLength: bytes.length });
    this.#pieces.push(padded);
    return { bufferView: this.views.length - 1 };
  }

  whole(): Uint8Array {
    return new Uint8Array(Buffer.concat(this.#pieces));
  }
}

/** The document and its binary chunk. */
export function everything(): Glb {
  const binary = new Binary();
  const extensions = { IRRADIA_lighting: lighting(binary) };
  const accessors = instanceTables(binary);
  const json = {
    asset: { version: "2.0" },
    buffers: [{ byteLength: binary.whole().length }],
    bufferViews: binary.views,
    accessors,
    nodes: nodes(),
    extensions,
  };
  return { json, binary: binary.whole() };
}

function lighting(binary: Binary): object {
  const map = (encoding: "rgb9e5" | "half"): object => ({
    ...binary.add(ktx2(encoding)),
    encoding,
    scale: 2,
  });
  const png = Uint8Array.of(137, 80, 78, 71);
  return {
    version: 1,
    lightmap: {
      quantity: "irradiance_over_pi",
      mimeType: "image/ktx2",
      ...map("rgb9e5"),
      exposure: -1.5,
      ...PAGES,
    },
    direct: map("half"),
    directional: { mode: "mono-sh", maps: { sh_l0: map("rgb9e5"), sh_direction: map("half") } },
    shadowMask: { pages: [0, 1].map(() => ({ mimeType: "image/png", ...binary.add(png) })) },
    validity: {
      pages: [0, 1].map((page) => ({ mimeType: "image/png", ...binary.add(Uint8Array.of(page)) })),
    },
    probes: probes(binary),
    field: {
      mimeType: "application/vnd.safetensors",
      ...binary.add(vector("hash-int8").bytes),
      mode: "irradiance",
      light: "indirect",
      min: [-1, 0, 0.5],
      max: [1, 2.25, 4.5],
    },
  };
}

function probes(binary: Binary): object {
  const floats = (n: number): object => binary.add(Float32Array.from({ length: n }, (_, i) => i / 8));
  return {
    light: "full",
    count: N_PROBES,
    scale: 2,
    coefficients: binary.add(new Uint16Array(27 * N_PROBES).map((_, i) => 0x3c00 + i)),
    positions: floats(3 * N_PROBES),
    offsets: floats(3 * N_PROBES),
    states: binary.add(Uint8Array.of(0, 1, 2, 0, 0, 0)),
    validities: floats(N_PROBES),
    sky: floats(4 * N_PROBES),
    reaches: floats(N_PROBES),
    distances: { ...binary.add(new Uint8Array(2 * 4 * N_PROBES)), size: 2 },
    octree: {
      origin: [0, 0, 0],
      size: 2,
      count: 1,
      cells: binary.add(Uint16Array.of(0, 0, 0, 1)),
      corners: binary.add(Uint32Array.of(0, 1, 2, 3, 4, 5, 0xffffffff, 0)),
    },
  };
}

/** Rectangles of two instances, and their pages; the second has none. */
function instanceTables(binary: Binary): object[] {
  const rectangles = binary.add(Float32Array.of(0.5, 0.5, 0, 0, 0.25, 0.25, 0.5, 0.5));
  const pages = binary.add(Uint16Array.of(1, 0xffff));
  return [
    { ...rectangles, componentType: 5126, count: 2, type: "VEC4" },
    { ...pages, componentType: 5123, count: 2, type: "SCALAR" },
  ];
}

function nodes(): object[] {
  const primitives = [
    [{ texCoord: 1, page: 0 }, {}, { texCoord: 2, page: 1, scale: [0.12, 0.12], offset: [0.5, 0.25] }],
    [{ texCoord: 1, scaleOffsets: 0, pages: 1 }],
  ];
  const lamp = { bakedLight: 0, bakedIesLight: { light: 4 }, shadowMaskChannel: 3 };
  return [
    ...primitives.map((entries) => ({ extensions: { IRRADIA_lighting: { primitives: entries } } })),
    { extensions: { IRRADIA_lighting: lamp } },
    { name: "bare" },
  ];
}

/** The file. */
export function glbBytes({ json, binary }: Glb): Uint8Array {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const padded = new Uint8Array(Math.ceil(text.length / 4) * 4).fill(0x20);
  padded.set(text);
  const bytes = new Uint8Array(28 + padded.length + binary.length);
  const view = new DataView(bytes.buffer);
  const words = [0x46546c67, 2, bytes.length, padded.length, 0x4e4f534a];
  words.forEach((word, i) => {
    view.setUint32(4 * i, word, true);
  });
  bytes.set(padded, 20);
  view.setUint32(20 + padded.length, binary.length, true);
  view.setUint32(24 + padded.length, 0x004e4942, true);
  bytes.set(binary, 28 + padded.length);
  return bytes;
}

/** Texel t of a page of `ktx2` is 2^(t mod 8) in red, half of it in green, none in blue. */
export function texelAt(index: number): [number, number, number] {
  const red = 2 ** (index % 8);
  return [red, red / 2, 0];
}

/** An unpacked texture of the pages' size. */
export function ktx2(encoding: "rgb9e5" | "half"): Uint8Array {
  const { width, height, pages } = PAGES;
  const count = width * height * pages;
  const texels = encoding === "half" ? halves(count) : words(count);
  const bytes = new Uint8Array(104 + texels.byteLength);
  const view = new DataView(bytes.buffer);
  bytes.set([0xab, 0x4b, 0x54, 0x58, 0x20, 0x32, 0x30, 0xbb, 0x0d, 0x0a, 0x1a, 0x0a]);
  const header = [encoding === "half" ? 97 : 123, 1, width, height, 0, pages, 1, 1, 0];
  header.forEach((value, i) => {
    view.setUint32(12 + 4 * i, value, true);
  });
  [104, texels.byteLength, texels.byteLength].forEach((value, i) => {
    view.setBigUint64(80 + 8 * i, BigInt(value), true);
  });
  bytes.set(new Uint8Array(texels.buffer), 104);
  return bytes;
}

function words(count: number): Uint32Array {
  return Uint32Array.from({ length: count }, (_, i) => {
    return (((i % 8) + 16) << 27) | (128 << 9) | 256; // 256 · 2^(e − 24) = 2^(e − 16)
  });
}

function halves(count: number): Uint16Array {
  return Uint16Array.from({ length: 4 * count }, (_, i) => {
    const exponent = 15 + ((i >> 2) % 8);
    return [exponent << 10, (exponent - 1) << 10, 0, 0x3c00][i % 4] ?? 0;
  });
}
