/** Cameras as `irradia render --save-camera` writes them. */
import { InputError } from "@irradia/runtime";
import { isYfov, type Pose, poseFromMatrix } from "../camera/pose.js";
import type { NamedFile } from "./kinds.js";

/** @param distance metres to what the camera is to orbit about */
export function readCameraFile({ name, bytes }: NamedFile, distance: number): Pose {
  const content = parse(bytes) as { world_from_camera?: unknown; yfov_deg?: unknown };
  const rows = content.world_from_camera;
  const yfovDeg = content.yfov_deg;
  const numbers = Array.isArray(rows) ? rows.flat().map(Number) : [];
  if (numbers.length !== 16 || !numbers.every(Number.isFinite) || typeof yfovDeg !== "number") {
    const fix = "Cameras are written by `irradia render --save-camera`.";
    throw new InputError("expected a camera, found other JSON", name, fix);
  }
  if (!isYfov(yfovDeg)) {
    throw new InputError(`expected an angle of view from 1 to 170 degrees, found ${yfovDeg}`, name);
  }
  const columns = numbers.map((_, i) => numbers[(i % 4) * 4 + Math.floor(i / 4)] ?? 0);
  return poseFromMatrix(columns, (yfovDeg * Math.PI) / 180, distance);
}

function parse(bytes: Uint8Array): object {
  try {
    const content: unknown = JSON.parse(new TextDecoder().decode(bytes));
    return typeof content === "object" && content !== null ? content : {};
  } catch {
    return {};
  }
}
