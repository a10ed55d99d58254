/** What a page says that it shows: scenes, more fields for them, and path-traced pictures of them. */
import { InputError } from "@irradia/runtime";
import { isYfov, type Pose, poseFromMatrix } from "../camera/pose.js";

export interface ManifestFile {
  readonly name: string;
  /** Relative to the page. */
  readonly url: string;
}

/** A path-traced picture and the camera that it was traced from. */
export interface ManifestPicture extends ManifestFile {
  /** `hdr` is linear radiance; `png` is shown at `ev` stops as our reports show pictures. */
  readonly kind: "hdr" | "png";
  readonly ev: number;
  readonly pose: Pose | undefined;
}

export interface ManifestScene extends ManifestFile {
  readonly fields: readonly ManifestFile[];
  readonly references: readonly ManifestPicture[];
}

export interface Manifest {
  readonly title: string;
  readonly scenes: readonly ManifestScene[];
  readonly start: { readonly scene: number; readonly source: string; readonly compare: string };
}

const FIX = "Write the page again with `irradia export --web` or `irradia view`.";
type Json = Readonly<Record<string, unknown>>;

/**
 * Reads a manifest's JSON; unknown keys are left alone.
 *
 * @param base what URLs in it are relative to
 */
export function readManifest(text: string, where: string, base = ""): Manifest {
  const root = parse(text, where);
  if (root.format !== "irradia-manifest" || root.version !== 1) {
    throw new InputError("expected a manifest of version 1", where, FIX);
  }
  const start = object(root.start);
  return {
    title: string(root.title),
    scenes: list(root.scenes, where, "scenes").map((scene, index) =>
      readScene(scene, `${where}#/scenes/${index}`, base),
    ),
    start: { scene: finite(start.scene) ?? 0, source: string(start.source), compare: string(start.compare) },
  };
}

function readScene(scene: Json, where: string, base: string): ManifestScene {
  return {
    ...readFile(scene, where, base),
    fields: list(scene.fields ?? [], where, "fields").map((field) => readFile(field, where, base)),
    references: list(scene.references ?? [], where, "references").map((picture) => ({
      ...readFile(picture, where, base),
      kind: picture.kind === "png" ? "png" : "hdr",
      ev: finite(picture.exposureEv) ?? 0,
      pose: readCamera(object(picture.camera)),
    })),
  };
}

function readFile(entry: Json, where: string, base: string): ManifestFile {
  if (typeof entry.url !== "string" || entry.url === "") {
    throw new InputError("expected a url", where, FIX);
  }
  return { name: string(entry.name) || entry.url, url: base + entry.url };
}

function readCamera(camera: Json): Pose | undefined {
  const matrix = camera.worldFromCamera;
  const yfovRad = finite(camera.yfovRad) ?? 0;
  const isWhole = Array.isArray(matrix) && matrix.length === 16 && matrix.every((x) => Number.isFinite(x));
  const isCamera = isWhole && isYfov((yfovRad * 180) / Math.PI);
  return isCamera ? poseFromMatrix(matrix, yfovRad, 1) : undefined;
}

function parse(text: string, where: string): Json {
  try {
    return object(JSON.parse(text));
  } catch {
    throw new InputError("expected JSON", where, FIX);
  }
}

function list(value: unknown, where: string, key: string): Json[] {
  if (!Array.isArray(value)) throw new InputError(`expected a list of ${key}`, where, FIX);
  return value.map(object);
}

function object(value: unknown): Json {
  return typeof value === "object" && value !== null ? (value as Json) : {};
}

function string(value: unknown): string {
  return typeof value === "string" ? value : "";
}

function finite(value: unknown): number | undefined {
  return typeof value === "number" && Number.isFinite(value) ? value : undefined;
}
