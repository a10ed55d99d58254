/** Files from outside: dropped anywhere on the page, or picked. */
import { ACCEPTED, type NamedFile } from "./kinds.js";

export type OnFiles = (files: readonly File[]) => void;

/** Takes files that are dropped on `element`, which has the class `dropping` while they hover. */
export function acceptDrops(element: HTMLElement, onFiles: OnFiles): void {
  let depth = 0;
  const hover = (change: number): void => {
    depth = Math.max(0, depth + change);
    element.classList.toggle("dropping", depth > 0);
  };
  element.addEventListener("dragenter", (event) => {
    event.preventDefault();
    hover(1);
  });
  element.addEventListener("dragleave", () => hover(-1));
  element.addEventListener("dragover", (event) => event.preventDefault());
  element.addEventListener("drop", (event) => {
    event.preventDefault();
    hover(-depth);
    const files = [...(event.dataTransfer?.files ?? [])];
    if (files.length > 0) onFiles(files);
  });
}

/** Lets someone choose files; must be called from a click or a key. */
export function pickFiles(onFiles: OnFiles): void {
  const input = document.createElement("input");
  input.type = "file";
  input.multiple = true;
  input.accept = ACCEPTED;
  input.addEventListener("change", () => {
    const files = [...(input.files ?? [])];
    if (files.length > 0) onFiles(files);
  });
  input.click();
}

/** Their bytes. */
export function readFiles(files: readonly File[]): Promise<NamedFile[]> {
  return Promise.all(
    files.map(async (file) => ({ name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) })),
  );
}
