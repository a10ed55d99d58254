/** Safetensors files taken apart and put together, to spoil them in between. */

/** The container's header. */
export interface Header {
  __metadata__: Record<string, string>;
  [tensor: string]: unknown;
}

/** An entry of it. */
export interface Entry {
  dtype: string;
  shape: number[];
  data_offsets: [number, number];
}

export interface Parts {
  header: Header;
  data: Uint8Array;
}

export function takeApart(bytes: Uint8Array): Parts {
  const nBytes = Number(new DataView(bytes.buffer, bytes.byteOffset).getBigUint64(0, true));
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(8, 8 + nBytes)));
  return { header, data: bytes.subarray(8 + nBytes) };
}

export function putTogether({ header, data }: Parts): Uint8Array {
  const text = new TextEncoder().encode(JSON.stringify(header));
  const bytes = new Uint8Array(8 + text.length + data.length);
  new DataView(bytes.buffer).setBigUint64(0, BigInt(text.length), true);
  bytes.set(text, 8);
  bytes.set(data, 8 + text.length);
  return bytes;
}

/** The file with the JSON of its metadata changed in place. */
export function withAbout(bytes: Uint8Array, change: (about: About) => void): Uint8Array {
  const parts = takeApart(bytes);
  const about = JSON.parse(parts.header.__metadata__["irradia.field"] ?? "") as About;
  change(about);
  parts.header.__metadata__["irradia.field"] = JSON.stringify(about);
  return putTogether(parts);
}

/** The file with its header changed in place. */
export function withHeader(bytes: Uint8Array, change: (header: Header) => void): Uint8Array {
  const parts = takeApart(bytes);
  change(parts.header);
  return putTogether(parts);
}

// biome-ignore lint/suspicious/noExplicitAny: tests put values there that no type allows
export type About = Record<string, any>;
