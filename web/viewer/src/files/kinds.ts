/** What kind of file something is: by its first bytes where they tell, else by its name. */

export type FileKind =
  | "scene"
  | "field"
  | "field-bin"
  | "environment-or-picture"
  | "picture"
  | "camera"
  | "resource"
  | "unknown";

/** A file's bytes and the name that it goes by. */
export interface NamedFile {
  readonly name: string;
  readonly bytes: Uint8Array;
}

/** What people are told that they can drop. */
export const ACCEPTED = ".glb,.gltf,.bin,.safetensors,.zst,.hdr,.exr,.png,.jpg,.jpeg,.json";

const ZSTD_MAGIC = [0x28, 0xb5, 0x2f, 0xfd];
const EXR_MAGIC = [0x76, 0x2f, 0x31, 0x01];
const PNG_MAGIC = [0x89, 0x50, 0x4e, 0x47];
const JPEG_MAGIC = [0xff, 0xd8, 0xff];

/** Bytes as three.js' loaders want them; copied only where they are part of something larger. */
export function wholeBuffer(bytes: Uint8Array): ArrayBuffer {
  const isWhole = bytes.byteLength === bytes.buffer.byteLength && bytes.buffer instanceof ArrayBuffer;
  return isWhole ? (bytes.buffer as ArrayBuffer) : bytes.slice().buffer;
}

/** Whether a file's name is that of something to open, as far as names tell. */
export function isKnownName(name: string): boolean {
  const lower = name.toLowerCase();
  return ACCEPTED.split(",").some((suffix) => lower.endsWith(suffix));
}

/** Radiance files are skies or renders: only their shape tells, see `isPanorama`. */
export function kindOf({ name, bytes }: NamedFile): FileKind {
  const lower = name.toLowerCase();
  const begins = (text: string): boolean => latin(bytes, text.length) === text;
  if (begins("glTF") || lower.endsWith(".glb") || lower.endsWith(".gltf")) return "scene";
  if (startsWith(bytes, ZSTD_MAGIC) || lower.endsWith(".zst")) return "field";
  if (lower.endsWith(".safetensors")) return "field";
  if (startsWith(bytes, EXR_MAGIC) || begins("#?RADIANCE") || begins("#?RGBE"))
    return "environment-or-picture";
  if (startsWith(bytes, PNG_MAGIC) || startsWith(bytes, JPEG_MAGIC)) return "picture";
  if (/\.(hdr|exr)$/.test(lower)) return "environment-or-picture";
  if (/\.(png|jpe?g)$/.test(lower)) return "picture";
  if (lower.endsWith(".json")) return "camera";
  return lower.endsWith(".bin") ? "field-bin" : "unknown";
}

/** Whether a picture's shape is that of a whole sphere's. */
export function isPanorama(width: number, height: number): boolean {
  return width === 2 * height;
}

/** The last part of a path or URL. */
export function fileName(address: string): string {
  const path = address.split(/[?#]/, 1)[0] ?? "";
  return decodeSafely(path.split("/").pop() || address);
}

function decodeSafely(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

function startsWith(bytes: Uint8Array, magic: readonly number[]): boolean {
  return magic.every((byte, index) => bytes[index] === byte);
}

function latin(bytes: Uint8Array, length: number): string {
  return String.fromCharCode(...bytes.subarray(0, length));
}
