/** The manifest of this page, if it has one: inside it, or beside it. */
import { openFile } from "./bytes.js";
import { type Manifest, readManifest } from "./manifest.js";

export async function manifestOfPage(): Promise<Manifest | undefined> {
  const element = document.getElementById("irradia-manifest");
  if (element) return readManifest(element.textContent ?? "", "the page's manifest");
  const url = document.querySelector<HTMLMetaElement>('meta[name="irradia-manifest"]')?.content;
  if (!url) return undefined;
  const text = new TextDecoder().decode(await openFile(url));
  return readManifest(text, url, url.replace(/[^/]*$/, ""));
}
