/** Where feet can stand: rays against the model's triangles. */
import { InstancedMesh, Matrix4, type Mesh, type Object3D, Vector3 } from "three/webgpu";
import { Floors } from "./floors.js";

/** Metres from the floor to the eyes. */
export const EYE_HEIGHT_M = 1.7;
/** Share of a room's height at which the eyes of someone smaller are. */
const LOW_ROOM = 0.6;
/** Metres to walls, and how high a step may be, of EYE_HEIGHT_M each. */
const BODY = 0.18;
const STEP = 0.35;
const DOWN = [0, -1, 0] as const;
const UP = [0, 1, 0] as const;

export class Ground {
  readonly #model: Object3D;
  #floors: Floors | undefined;
  /** As frames ask again and again for someone who stands still. */
  #last: { readonly place: Vector3; readonly height: number | undefined } | undefined;

  constructor(model: Object3D) {
    this.#model = model;
  }

  /**
   * The height of the eyes of someone whose feet are under `place`.
   *
   * @returns metres, world space; undefined where there is no floor
   */
  eyeHeight(place: Vector3): number | undefined {
    if (!this.#last?.place.equals(place)) this.#last = { place: place.clone(), height: this.#find(place) };
    return this.#last.height;
  }

  #find({ x, y, z }: Vector3): number | undefined {
    const floor = this.#all.distance([x, y, z], DOWN);
    if (floor === undefined) return undefined;
    const feet = y - floor;
    const room = this.#all.distance([x, feet + 1e-3, z], UP);
    return feet + Math.min(EYE_HEIGHT_M, (room ?? Number.POSITIVE_INFINITY) * LOW_ROOM);
  }

  /** Shortens a horizontal step so that it ends before walls; what is below a step's height is climbed. */
  clip(place: Vector3, step: Vector3): Vector3 {
    const length = step.length();
    if (length === 0) return step;
    const height = (this.eyeHeight(place) ?? place.y) - place.y + EYE_HEIGHT_M;
    const scale = Math.min(height, EYE_HEIGHT_M) / EYE_HEIGHT_M;
    const waist = place.y - (EYE_HEIGHT_M - STEP) * scale * 0.5;
    const way = [step.x / length, 0, step.z / length] as const;
    const body = BODY * scale;
    const free = this.#all.distance([place.x, waist, place.z], way, length + body);
    return free === undefined ? step : step.multiplyScalar(Math.max(0, free - body) / length);
  }

  /** Made when someone first walks. */
  get #all(): Floors {
    this.#floors ??= new Floors(trianglesOf(this.#model));
    return this.#floors;
  }
}

/** Corners in world space, nine numbers a triangle. */
function trianglesOf(model: Object3D): Float32Array {
  const parts: Float32Array[] = [];
  model.updateMatrixWorld(true);
  model.traverseVisible((object) => {
    if (!("isMesh" in object)) return;
    for (const matrix of matricesOf(object as Mesh)) parts.push(placed(object as Mesh, matrix));
  });
  const all = new Float32Array(parts.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

function matricesOf(mesh: Mesh): Matrix4[] {
  if (!(mesh instanceof InstancedMesh)) return [mesh.matrixWorld];
  return Array.from({ length: mesh.count }, (_, i) => {
    const own = new Matrix4();
    mesh.getMatrixAt(i, own);
    return own.premultiply(mesh.matrixWorld);
  });
}

function placed({ geometry }: Mesh, matrix: Matrix4): Float32Array {
  const { index } = geometry;
  const position = geometry.getAttribute("position");
  const count = 3 * Math.floor((index?.count ?? position?.count ?? 0) / 3);
  const corners = new Float32Array(3 * count);
  const corner = new Vector3();
  for (let i = 0; i < count; i += 1) {
    corner.fromBufferAttribute(position as never, index?.getX(i) ?? i).applyMatrix4(matrix);
    corner.toArray(corners, 3 * i);
  }
  return corners;
}
