/** The camera of a view. */
import { Matrix4, PerspectiveCamera } from "three";
import type { View } from "../view.js";

export function cameraOf({ width, height, worldFromCamera, yfovRad }: View): PerspectiveCamera {
  if (yfovRad === undefined) throw new Error("a view needs yfovRad");
  const camera = new PerspectiveCamera((yfovRad * 180) / Math.PI, width / height, 0.05, 200);
  new Matrix4().fromArray(worldFromCamera).decompose(camera.position, camera.quaternion, camera.scale);
  return camera;
}
