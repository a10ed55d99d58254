/** Where a camera stands and where it looks, without three.js. */
import type { Vec3 } from "@irradia/runtime";

/** Metres in world space; +Y is up. */
export interface Pose {
  readonly eye: Vec3;
  /** What it looks at, and orbits about. */
  readonly target: Vec3;
  /** Angle of view from bottom to top. */
  readonly yfovDeg: number;
}

/** An axis-aligned box, metres. */
export interface Box {
  readonly min: Vec3;
  readonly max: Vec3;
}

export const DEFAULT_YFOV_DEG = 45;
/** Narrower and wider angles are mistakes. */
const [LEAST_YFOV_DEG, MOST_YFOV_DEG] = [1, 170];
/** Enough for a tenth of a millimetre in a kilometre. */
const DIGITS = 7;
const RAD = Math.PI / 180;
/** From where a scene is seen as a whole: front right, a little above. */
const FRAMING_DIRECTION: Vec3 = [0.55, 0.35, 0.76];

/** `x,y,z,x,y,z,yfovDeg`: eye, target, angle; the last may be left out. */
export function writePose({ eye, target, yfovDeg }: Pose): string {
  return [...eye, ...target, yfovDeg].map((x) => String(Number(x.toPrecision(DIGITS)))).join(",");
}

/** What `writePose` wrote; undefined for anything else. */
export function readPose(text: string): Pose | undefined {
  const values = text.split(",").map((part) => (part.trim() === "" ? Number.NaN : Number(part)));
  const isWhole = (values.length === 6 || values.length === 7) && values.every(Number.isFinite);
  if (!isWhole) return undefined;
  const [x = 0, y = 0, z = 0, tx = 0, ty = 0, tz = 0, yfovDeg = DEFAULT_YFOV_DEG] = values;
  const looksSomewhere = x !== tx || y !== ty || z !== tz;
  if (!looksSomewhere || !isYfov(yfovDeg)) return undefined;
  return { eye: [x, y, z], target: [tx, ty, tz], yfovDeg };
}

/** Whether a camera can have this angle of view from bottom to top, degrees. */
export function isYfov(yfovDeg: number): boolean {
  return yfovDeg >= LEAST_YFOV_DEG && yfovDeg <= MOST_YFOV_DEG;
}

/**
 * The pose of a camera's matrix.
 *
 * @param worldFromCamera column by column; the camera looks along its −Z
 * @param distance metres to what it is to orbit about
 */
export function poseFromMatrix(worldFromCamera: ArrayLike<number>, yfovRad: number, distance: number): Pose {
  const at = (index: number): number => worldFromCamera[index] ?? 0;
  const eye: Vec3 = [at(12), at(13), at(14)];
  const length = Math.hypot(at(8), at(9), at(10)) || 1;
  const along = (axis: number): number => (eye[axis] ?? 0) - (at(8 + axis) / length) * distance;
  return { eye, target: [along(0), along(1), along(2)], yfovDeg: yfovRad / RAD };
}

/** A pose that shows all of a box in a window of `aspect` = width / height. */
export function framePose(box: Box, aspect: number, yfovDeg: number = DEFAULT_YFOV_DEG): Pose {
  const target = centre(box);
  const radius = 0.5 * diagonal(box) || 1;
  const halfY = Math.tan((yfovDeg / 2) * RAD);
  const half = Math.atan(Math.min(halfY, halfY * aspect));
  const distance = radius / Math.sin(half);
  const length = Math.hypot(...FRAMING_DIRECTION);
  const from = (axis: 0 | 1 | 2): number => target[axis] + (FRAMING_DIRECTION[axis] / length) * distance;
  return { eye: [from(0), from(1), from(2)], target, yfovDeg };
}

export function centre({ min, max }: Box): Vec3 {
  return [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
}

/** Metres from corner to corner. */
export function diagonal({ min, max }: Box): number {
  return Math.hypot(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
}

/** Whether two poses show the same picture, to a few pixels. */
export function isSamePose(one: Pose, other: Pose): boolean {
  const direction = (pose: Pose): number[] => {
    const way = pose.target.map((x, axis) => x - (pose.eye[axis] ?? 0));
    const length = Math.hypot(...way) || 1;
    return way.map((x) => x / length);
  };
  const apart = (a: readonly number[], b: readonly number[]): number =>
    Math.hypot(...a.map((x, axis) => x - (b[axis] ?? 0)));
  const reach = Math.hypot(...one.target.map((x, axis) => x - (one.eye[axis] ?? 0)));
  return (
    apart(one.eye, other.eye) <= 1e-3 * reach &&
    apart(direction(one), direction(other)) < 1e-3 &&
    Math.abs(one.yfovDeg - other.yfovDeg) < 0.05
  );
}
