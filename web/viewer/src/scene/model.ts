/** A loaded scene, whichever file it came from. */
import type { Field } from "@irradia/runtime";
import type { SceneLight } from "@irradia/three/webgpu";
import { Box3, type Group, type Mesh, type Object3D, PerspectiveCamera, Vector3 } from "three/webgpu";
import { type Box, centre, diagonal, framePose, type Pose, poseFromMatrix } from "../camera/pose.js";

/** A camera of the file. */
export interface NamedPose {
  readonly name: string;
  readonly pose: Pose;
}

/** What came over the wire. */
export interface FileBytes {
  readonly file: number;
  /** Of each buffer view. */
  readonly views: readonly number[];
}

export interface Model {
  readonly name: string;
  readonly bytes: FileBytes;
  readonly root: Group;
  readonly light: SceneLight;
  readonly box: Box;
  readonly cameras: readonly NamedPose[];
  readonly nTriangles: number;
  /** By the names of their sources: the file's own, and those that were added. */
  readonly fields: Map<string, Field>;
  /** Bytes of fields that came in files of their own, likewise. */
  readonly fieldBytes: Map<string, number>;
  /** Whether it has lights of its own. */
  readonly hasLights: boolean;
}

/** What is known of a scene once it is loaded. */
export function makeModel(name: string, bytes: FileBytes, root: Group, light: SceneLight): Model {
  root.updateMatrixWorld(true);
  const box = boxOf(root);
  let [nTriangles, hasLights] = [0, false];
  root.traverse((object) => {
    nTriangles += trianglesOf(object);
    hasLights ||= "isLight" in object;
  });
  const fields = new Map<string, Field>(light.baked?.field ? [["field", light.baked.field]] : []);
  return {
    name,
    bytes,
    root,
    light,
    box,
    cameras: camerasOf(root, box),
    nTriangles,
    fields,
    fieldBytes: new Map(),
    hasLights,
  };
}

/** What a camera sees at first: the file's own, else all of the scene. */
export function startPose(model: Model, aspect: number): Pose {
  return model.cameras[0]?.pose ?? framePose(model.box, aspect);
}

/** Frees what a model has on the GPU. */
export function disposeModel({ root, light }: Model): void {
  light.dispose();
  root.traverse((object) => {
    const { geometry, material } = object as Mesh;
    geometry?.dispose();
    for (const one of [material ?? []].flat()) {
      for (const value of Object.values(one)) if (value?.isTexture) value.dispose();
      one.dispose();
    }
  });
}

function boxOf(root: Object3D): Box {
  const box = new Box3().setFromObject(root);
  if (box.isEmpty()) box.set(new Vector3(-1, -1, -1), new Vector3(1, 1, 1));
  return { min: box.min.toArray(), max: box.max.toArray() };
}

function camerasOf(root: Object3D, box: Box): NamedPose[] {
  const poses: NamedPose[] = [];
  root.traverse((object) => {
    if (!(object instanceof PerspectiveCamera)) return;
    const eye = new Vector3().setFromMatrixPosition(object.matrixWorld);
    const distance = Math.max(eye.distanceTo(new Vector3(...centre(box))), 0.01 * diagonal(box));
    const pose = poseFromMatrix(object.matrixWorld.elements, (object.fov * Math.PI) / 180, distance);
    poses.push({ name: object.name || `Camera ${poses.length + 1}`, pose });
  });
  return poses;
}

function trianglesOf(object: Object3D): number {
  const { isMesh, geometry } = object as Mesh;
  if (!isMesh) return 0;
  const count = ("count" in object && typeof object.count === "number" ? object.count : 1) / 3;
  return Math.floor((geometry.index?.count ?? geometry.attributes.position?.count ?? 0) * count);
}
