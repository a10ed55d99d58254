/**
 * Bytes of a file that the page names: from a `<script data-irradia-file>` of this very page where there is
 * one (then the page works offline), else from the network.
 */
import { InputError } from "@irradia/runtime";

/** Letters of base64 that are turned into bytes at a time; each four are three bytes. */
const SLICE = 2 ** 20;
/** Of new browsers only; TypeScript doesn't know it yet. */
const Bytes = Uint8Array as { fromBase64?: (text: string) => Uint8Array<ArrayBuffer> };

/** How far a download is; `total` is 0 where the server doesn't say. */
export type OnProgress = (received: number, total: number) => void;

export interface OpenOptions {
  readonly onProgress?: OnProgress;
  /** Ends the download. */
  readonly signal?: AbortSignal;
}

export async function openFile(url: string, options: OpenOptions = {}): Promise<Uint8Array> {
  const element = embedded(url);
  return element ? unpack(element, url) : download(url, options);
}

function embedded(url: string): HTMLScriptElement | undefined {
  const all = document.querySelectorAll<HTMLScriptElement>("script[data-irradia-file]");
  return [...all].find((element) => element.dataset.irradiaFile === url);
}

async function unpack(element: HTMLScriptElement, url: string): Promise<Uint8Array> {
  const bytes = bytesFromBase64(element.textContent ?? "", url);
  if (element.dataset.encoding !== "gzip") return bytes;
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  try {
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new InputError("expected gzip, found damaged bytes", url, "Write the page again.");
  }
}

/** @param where the file's address, for errors */
export function bytesFromBase64(text: string, where: string): Uint8Array<ArrayBuffer> {
  try {
    return Bytes.fromBase64?.(text) ?? bytesBySlices(text);
  } catch {
    throw new InputError("expected base64, found other letters", where, "Write the page again.");
  }
}

/** For browsers without `fromBase64`: in slices, as each letter of a string may take eight bytes and more. */
export function bytesBySlices(text: string): Uint8Array<ArrayBuffer> {
  const letters = text.replace(/\s+/g, "");
  const bytes = new Uint8Array(3 * Math.ceil(letters.length / 4));
  let length = 0;
  for (let from = 0; from < letters.length; from += SLICE) {
    const part = atob(letters.slice(from, from + SLICE));
    for (let i = 0; i < part.length; i += 1) bytes[length + i] = part.charCodeAt(i);
    length += part.length;
  }
  return bytes.subarray(0, length);
}

async function download(url: string, { onProgress, signal }: OpenOptions): Promise<Uint8Array> {
  const response = await answer(url, signal);
  const total = Number(response.headers.get("content-length") ?? 0);
  const reader = response.body?.getReader();
  if (!reader) return new Uint8Array(await response.arrayBuffer());
  const parts: Uint8Array<ArrayBuffer>[] = [];
  let received = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    received += value.length;
    onProgress?.(received, total);
  }
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}

async function answer(url: string, signal: AbortSignal | undefined): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(url, { signal: signal ?? null });
  } catch {
    signal?.throwIfAborted();
    const fix =
      location.protocol === "file:"
        ? "Pages opened from a disk may not read other files: use `irradia view`, or drop the file here."
        : "Is the server still there, and does it let this page read its files?";
    throw new InputError("expected a file, got no answer", url, fix);
  }
  if (response.ok) return response;
  const found = `expected a file, got ${response.status} ${response.statusText}`.trim();
  throw new InputError(found, url, "Check the address.");
}
