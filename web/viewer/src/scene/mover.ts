/** Something white to move through the light. */
import {
  BoxGeometry,
  type BufferGeometry,
  type Camera,
  Mesh,
  MeshStandardMaterial,
  Plane,
  Raycaster,
  SphereGeometry,
  TorusKnotGeometry,
  Vector2,
  Vector3,
} from "three/webgpu";
import type { ObjectShape, Place } from "../state/state.js";
import type { Movable } from "./stage.js";

/** Radius of what moves, in parts of the scene's size. */
const SIZE = 0.045;
const UP = new Vector3(0, 1, 0);

const SHAPES: Readonly<Record<Exclude<ObjectShape, "off">, () => BufferGeometry>> = {
  sphere: () => new SphereGeometry(1, 48, 32),
  knot: () => new TorusKnotGeometry(0.62, 0.24, 160, 24),
  card: () => new BoxGeometry(1.7, 1.7, 0.05),
};

export interface MoverOptions {
  readonly element: HTMLElement;
  readonly camera: Camera;
  /** While it is dragged. */
  readonly onMove: () => void;
  readonly onPlace: (place: Place) => void;
}

export class Mover implements Movable {
  readonly mesh = new Mesh(undefined, new MeshStandardMaterial({ color: 0xcccccc, roughness: 1 }));
  readonly #options: MoverOptions;
  readonly #raycaster = new Raycaster();
  readonly #plane = new Plane();
  readonly #grip = new Vector3();
  #dragging: number | undefined;

  constructor(options: MoverOptions) {
    this.#options = options;
    this.mesh.visible = false;
    const { element } = options;
    // Before the camera's controls hear of it.
    element.addEventListener("pointerdown", (event) => this.#grab(event), { capture: true });
    element.addEventListener("pointermove", (event) => this.#drag(event), { capture: true });
    for (const end of ["pointerup", "pointercancel"] as const) {
      element.addEventListener(end, (event) => this.#drop(event), { capture: true });
    }
  }

  /** @param size of the scene, metres */
  show(shape: ObjectShape, size: number): void {
    this.mesh.visible = shape !== "off";
    if (shape === "off") return;
    this.mesh.scale.setScalar(SIZE * size);
    this.mesh.updateMatrixWorld();
    if (this.mesh.userData.shape === shape) return;
    this.mesh.geometry.dispose();
    this.mesh.geometry = SHAPES[shape]();
    this.mesh.userData.shape = shape;
  }

  get place(): Place {
    return this.mesh.position.toArray();
  }

  set place(place: Place) {
    this.mesh.position.set(...place);
    this.mesh.updateMatrixWorld();
  }

  #grab(event: PointerEvent): void {
    if (!this.mesh.visible || event.button !== 0) return;
    this.#aim(event);
    const hit = this.#raycaster.intersectObject(this.mesh, false)[0];
    if (!hit) return;
    event.stopPropagation();
    this.#options.element.setPointerCapture(event.pointerId);
    this.#dragging = event.pointerId;
    this.#grip.copy(this.mesh.position).sub(hit.point);
    this.#plane.setFromNormalAndCoplanarPoint(this.#planeNormal(event.shiftKey), hit.point);
  }

  #drag(event: PointerEvent): void {
    if (event.pointerId !== this.#dragging) return;
    event.stopPropagation();
    this.#aim(event);
    const point = this.#raycaster.ray.intersectPlane(this.#plane, new Vector3());
    if (!point) return;
    this.mesh.position.copy(point.add(this.#grip));
    this.mesh.updateMatrixWorld();
    this.#options.onMove();
  }

  #drop(event: PointerEvent): void {
    if (event.pointerId !== this.#dragging) return;
    event.stopPropagation();
    this.#dragging = undefined;
    this.#options.onPlace(this.place);
  }

  #aim(event: PointerEvent): void {
    const { left, top, width, height } = this.#options.element.getBoundingClientRect();
    const place = new Vector2((event.clientX - left) / width, (event.clientY - top) / height);
    this.#raycaster.setFromCamera(
      place.multiplyScalar(2).subScalar(1).multiply(new Vector2(1, -1)),
      this.#options.camera,
    );
  }

  /** The floor's, or that of a wall which faces the camera; the floor's too where it is seen edge-on. */
  #planeNormal(isUpright: boolean): Vector3 {
    const towards = this.#options.camera.getWorldDirection(new Vector3()).negate();
    if (!isUpright && Math.abs(towards.y) > 0.12) return UP.clone();
    return isUpright ? towards.setY(0).normalize() : towards;
  }
}
