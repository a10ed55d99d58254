/** Moves the camera as orbit, fly or walk, and tells where it stands. */
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Euler, type Object3D, type PerspectiveCamera, Vector3 } from "three/webgpu";
import type { Navigation } from "../state/state.js";
import { Look } from "./look.js";
import { type Box, diagonal, isSamePose, type Pose } from "./pose.js";
import { Ground } from "./walk.js";

const HALF_TURN = Math.PI / 2 - 0.01;
/** Seconds from one end of the scene to the other, flying. */
const CROSSING_S = 6;
const WALKING_M_PER_S = 1.5;
/** Share of the way to the right eye height that is left after a second. */
const SETTLING = 1e-4;

export interface RigOptions {
  readonly camera: PerspectiveCamera;
  readonly element: HTMLElement;
  /** Whether movement runs out softly. */
  readonly isSmooth: boolean;
  /** Told when the camera moves, or wants to at the next frame. */
  readonly onChange: () => void;
}

export class Rig {
  readonly #options: RigOptions;
  readonly #target = new Vector3();
  #orbit: OrbitControls | undefined;
  #look: Look | undefined;
  #ground: Ground | undefined;
  #navigation: Navigation = "orbit";
  #size = 1;

  constructor(options: RigOptions) {
    this.#options = options;
    this.navigation = "orbit";
  }

  /** Adapts speed to a model, and finds its floors. */
  setModel(model: Object3D, box: Box): void {
    this.#ground = new Ground(model);
    this.#size = diagonal(box) || 1;
  }

  get pose(): Pose {
    const { camera } = this.#options;
    return { eye: camera.position.toArray(), target: this.#target.toArray(), yfovDeg: camera.fov };
  }

  set pose(pose: Pose) {
    const { camera } = this.#options;
    camera.position.set(...pose.eye);
    this.#target.set(...pose.target);
    camera.fov = pose.yfovDeg;
    camera.updateProjectionMatrix();
    camera.lookAt(this.#target);
    this.#orbit?.target.copy(this.#target);
    this.#orbit?.update();
    this.#options.onChange();
  }

  set navigation(navigation: Navigation) {
    this.#orbit?.dispose();
    this.#look?.dispose();
    this.#orbit = this.#look = undefined;
    this.#navigation = navigation;
    if (navigation === "orbit") this.#orbit = this.#makeOrbit();
    else this.#look = new Look(this.#options.element, this.#options.onChange);
    this.#options.onChange();
  }

  /**
   * Moves on.
   *
   * @returns whether there is more to do in the next frame
   */
  update(seconds: number): boolean {
    const before = this.pose;
    if (this.#orbit) {
      this.#orbit.update();
      this.#target.copy(this.#orbit.target);
      return !isSamePose(before, this.pose);
    }
    return this.#look ? this.#step(this.#look, seconds) : false;
  }

  #makeOrbit(): OrbitControls {
    const { camera, element, isSmooth, onChange } = this.#options;
    const orbit = new OrbitControls(camera, element);
    orbit.target.copy(this.#target);
    orbit.enableDamping = isSmooth;
    orbit.dampingFactor = 0.15;
    orbit.zoomToCursor = false;
    orbit.addEventListener("change", onChange);
    return orbit;
  }

  #step(look: Look, seconds: number): boolean {
    const { camera } = this.#options;
    const { yaw, pitch, move, stride, speed } = look.take();
    const reach = camera.position.distanceTo(this.#target);
    const turn = new Euler().setFromQuaternion(camera.quaternion, "YXZ");
    turn.set(clampTurn(turn.x + pitch), turn.y + yaw, 0, "YXZ");
    camera.quaternion.setFromEuler(turn);
    const isWalk = this.#navigation === "walk";
    const pace = speed * (isWalk ? Math.min(WALKING_M_PER_S, this.#size / 4) : this.#size / CROSSING_S);
    const along = (axis: 0 | 1 | 2): number => (move[axis] * seconds + stride[axis]) * pace;
    const way = new Vector3(along(0), isWalk ? 0 : along(1), -along(2));
    way.applyEuler(isWalk ? new Euler(0, turn.y, 0) : turn);
    camera.position.add(isWalk && this.#ground ? this.#ground.clip(camera.position, way) : way);
    const settles = isWalk && this.#settle(seconds);
    this.#lookAhead(reach);
    return look.isMoving || settles;
  }

  /** Brings the eyes to their height above the floor. */
  #settle(seconds: number): boolean {
    const { position } = this.#options.camera;
    const wanted = this.#ground?.eyeHeight(position);
    if (wanted === undefined) return false;
    const gap = wanted - position.y;
    const isThere = Math.abs(gap) < 1e-3 * this.#size || !this.#options.isSmooth;
    position.y = isThere ? wanted : wanted - gap * SETTLING ** seconds;
    return !isThere;
  }

  /** Keeps what orbit would turn about in front of the camera, as far away as it was. */
  #lookAhead(reach: number): void {
    const { camera } = this.#options;
    const distance = Math.max(reach, this.#size * 0.01);
    camera.getWorldDirection(this.#target).multiplyScalar(distance).add(camera.position);
  }
}

function clampTurn(pitch: number): number {
  return Math.max(-HALF_TURN, Math.min(HALF_TURN, pitch));
}
