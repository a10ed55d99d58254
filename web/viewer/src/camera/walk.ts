/** Where feet can stand: rays against the model. */
import { type Object3D, Raycaster, Vector3 } from "three/webgpu";

/** Metres from the floor to the eyes. */
export const EYE_HEIGHT_M = 1.7;
/** Share of a room's height at which the eyes of someone smaller are. */
const LOW_ROOM = 0.6;
/** Metres to walls, and how high a step may be, of EYE_HEIGHT_M each. */
const BODY = 0.18;
const STEP = 0.35;
const DOWN = new Vector3(0, -1, 0);
const UP = new Vector3(0, 1, 0);

export class Ground {
  readonly #raycaster = new Raycaster();
  readonly #from = new Vector3();

  constructor(readonly model: Object3D) {}

  /**
   * The height of the eyes of someone whose feet are under `place`.
   *
   * @returns metres, world space; undefined where there is no floor
   */
  eyeHeight(place: Vector3): number | undefined {
    const floor = this.#distance(this.#from.copy(place), DOWN);
    if (floor === undefined) return undefined;
    const feet = place.y - floor;
    const room = this.#distance(this.#from.set(place.x, feet + 1e-3, place.z), UP);
    return feet + Math.min(EYE_HEIGHT_M, (room ?? Number.POSITIVE_INFINITY) * LOW_ROOM);
  }

  /** Shortens a horizontal step so that it ends before walls; what is below a step's height is climbed. */
  clip(place: Vector3, step: Vector3): Vector3 {
    const length = step.length();
    if (length === 0) return step;
    const height = (this.eyeHeight(place) ?? place.y) - place.y + EYE_HEIGHT_M;
    const scale = Math.min(height, EYE_HEIGHT_M) / EYE_HEIGHT_M;
    this.#from.copy(place).addScaledVector(DOWN, (EYE_HEIGHT_M - STEP) * scale * 0.5);
    const free = this.#distance(this.#from, step.clone().normalize());
    if (free === undefined) return step;
    return step.multiplyScalar(Math.min(1, Math.max(0, free - BODY * scale) / length));
  }

  #distance(from: Vector3, direction: Vector3): number | undefined {
    this.#raycaster.set(from, direction);
    return this.#raycaster.intersectObject(this.model, true)[0]?.distance;
  }
}
