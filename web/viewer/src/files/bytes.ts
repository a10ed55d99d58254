/**
 * Bytes of a file that the page names: from a `<script data-irradia-file>` of this very page where there is
 * one (then the page works offline), else from the network.
 */
import { InputError } from "@irradia/runtime";

/** How far a download is; `total` is 0 where the server doesn't say. */
export type OnProgress = (received: number, total: number) => void;

export async function openFile(url: string, onProgress?: OnProgress): Promise<Uint8Array> {
  const element = embedded(url);
  return element ? unpack(element, url) : download(url, onProgress);
}

/** Whether the page holds the file itself. */
export function isEmbedded(url: string): boolean {
  return embedded(url) !== undefined;
}

function embedded(url: string): HTMLScriptElement | undefined {
  const all = document.querySelectorAll<HTMLScriptElement>("script[data-irradia-file]");
  return [...all].find((element) => element.dataset.irradiaFile === url);
}

async function unpack(element: HTMLScriptElement, url: string): Promise<Uint8Array> {
  const bytes = fromBase64(element.textContent ?? "", url);
  if (element.dataset.encoding !== "gzip") return bytes;
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  try {
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw new InputError("expected gzip, found damaged bytes", url, "Write the page again.");
  }
}

function fromBase64(text: string, url: string): Uint8Array<ArrayBuffer> {
  try {
    return Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));
  } catch {
    throw new InputError("expected base64, found other letters", url, "Write the page again.");
  }
}

async function download(url: string, onProgress?: OnProgress): Promise<Uint8Array> {
  const response = await answer(url);
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

async function answer(url: string): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(url);
  } catch {
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
