/** Files from outside: dropped anywhere on the page, with the folders that they lie in, or picked. */
import { InputError } from "@irradia/runtime";
import { ACCEPTED, isKnownName, type NamedFile } from "./kinds.js";

/** Gets the bytes of what someone chose; may be called more than once. */
export type ReadFiles = () => Promise<NamedFile[]>;
export type OnFiles = (read: ReadFiles) => void;

/** More in a folder aren't a scene but a whole disk. */
const MOST_FILES = 256;

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
    const dropped = takeDropped(event.dataTransfer);
    if (dropped.length > 0) onFiles(async () => readAll((await Promise.all(dropped.map(filesOf))).flat()));
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
    if (files.length > 0) onFiles(() => readAll(files));
  });
  input.click();
}

/** A file, or a folder that is still to be walked; only while the event lasts can they be told apart. */
function takeDropped(transfer: DataTransfer | null): (File | FileSystemDirectoryEntry)[] {
  return [...(transfer?.items ?? [])].flatMap((item) => {
    const entry = item.kind === "file" ? item.webkitGetAsEntry?.() : undefined;
    return entry?.isDirectory ? (entry as FileSystemDirectoryEntry) : (item.getAsFile() ?? []);
  });
}

/** Of a folder all those, at any depth, that the viewer may know. */
async function filesOf(dropped: File | FileSystemDirectoryEntry): Promise<File[]> {
  if (dropped instanceof File) return [dropped];
  const files: File[] = [];
  await walk(dropped, files);
  if (files.length > 0) return files;
  const fix = `Drop a folder with a scene in it: ${ACCEPTED.replaceAll(",", ", ")}.`;
  throw new InputError("expected files that the viewer knows, found none", dropped.name, fix);
}

async function walk(folder: FileSystemDirectoryEntry, files: File[]): Promise<void> {
  const reader = folder.createReader();
  for (;;) {
    const entries = await new Promise<FileSystemEntry[]>((resolve, reject) => {
      reader.readEntries(resolve, reject);
    });
    if (entries.length === 0) return;
    for (const entry of entries) {
      if (entry.isDirectory) await walk(entry as FileSystemDirectoryEntry, files);
      else if (isKnownName(entry.name)) files.push(await fileOf(entry as FileSystemFileEntry));
      if (files.length <= MOST_FILES) continue;
      const finding = `expected at most ${MOST_FILES} files, found more`;
      throw new InputError(finding, folder.fullPath, "Drop the scene's own folder.");
    }
  }
}

function fileOf(entry: FileSystemFileEntry): Promise<File> {
  return new Promise((resolve, reject) => {
    entry.file(resolve, reject);
  });
}

function readAll(files: readonly File[]): Promise<NamedFile[]> {
  return Promise.all(
    files.map(async (file) => {
      try {
        return { name: file.name, bytes: new Uint8Array(await file.arrayBuffer()) };
      } catch {
        const fix = "Is it still there, and may you read it?";
        throw new InputError("expected a file, found nothing that can be read", file.name, fix);
      }
    }),
  );
}
