/** The scene graph: the model, the sky, what can be moved, probes, and the camera. */
import {
  type Camera,
  HemisphereLight,
  type Object3D,
  PerspectiveCamera,
  Scene,
  type Texture,
  Vector3,
} from "three/webgpu";
import { type Box, DEFAULT_YFOV_DEG, diagonal } from "../camera/pose.js";
import type { ObjectShape, Place, ProbeView } from "../state/state.js";
import { disposeModel, type Model } from "./model.js";
import { ProbeSpheres } from "./probe-spheres.js";

/** W·m⁻² from above; enough to see shapes by. */
const STUDIO_INTENSITY = 3;
/** How much nearer than the farthest corner things may be. */
const DEPTH_RANGE = 5000;

/** Something that moves and is lit by what lights the scene. */
export interface Movable {
  readonly mesh: Object3D;
  show(shape: ObjectShape, size: number): void;
  place: Place;
}

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(DEFAULT_YFOV_DEG, 1, 0.01, 1000);
  readonly #studio = new HemisphereLight(0xffffff, 0x55504a, STUDIO_INTENSITY);
  #model: Model | undefined;
  #environment: Texture | undefined;
  #probes: ProbeSpheres | undefined;
  #movable: Object3D | undefined;

  get model(): Model | undefined {
    return this.#model;
  }

  /** Metres. */
  get size(): number {
    return this.#model ? diagonal(this.#model.box) || 1 : 1;
  }

  /** Whether the studio's light shines, as nothing else does. */
  get isStudio(): boolean {
    return this.#studio.parent !== null;
  }

  /** Takes the place of the model before, which is freed. */
  setModel(model: Model, movable: Movable): void {
    if (this.#model) {
      this.#model.light.unlit(movable.mesh);
      this.scene.remove(this.#model.root);
      disposeModel(this.#model);
    }
    this.#dropProbes();
    this.#model = model;
    this.#movable = movable.mesh;
    this.scene.add(model.root, movable.mesh);
    model.light.lit(movable.mesh);
    this.#light();
  }

  setEnvironment(texture: Texture | undefined): void {
    this.#environment?.dispose();
    this.#environment = texture;
    this.scene.environment = this.scene.background = texture ?? null;
    this.#light();
  }

  showProbes(view: ProbeView, ev: number): void {
    const probes = this.#model?.light.baked?.probes;
    if (!probes) return;
    if (!this.#probes && view !== "off") {
      this.#probes = new ProbeSpheres(probes, this.size);
      this.scene.add(this.#probes.mesh);
    }
    this.#probes?.show(view);
    if (this.#probes) this.#probes.ev = ev;
  }

  /** What can be seen now but isn't of the scene: probes, and what moves through its light. */
  get guests(): readonly Object3D[] {
    const all = [this.#movable, this.#probes?.mesh];
    return all.filter((guest) => guest?.visible === true) as Object3D[];
  }

  /** To be called before each frame: near and far as close to the scene as they can be. */
  fitDepth(): void {
    if (!this.#model) return;
    const { camera } = this;
    const far = 1.02 * farthest(camera, this.#model.box) + 0.1 * this.size;
    if (Math.abs(far - camera.far) < 0.01 * far) return;
    [camera.near, camera.far] = [far / DEPTH_RANGE, far];
    camera.updateProjectionMatrix();
  }

  setSize(width: number, height: number): void {
    this.camera.aspect = width / Math.max(height, 1);
    this.camera.updateProjectionMatrix();
  }

  #dropProbes(): void {
    if (!this.#probes) return;
    this.scene.remove(this.#probes.mesh);
    this.#probes.dispose();
    this.#probes = undefined;
  }

  #light(): void {
    const model = this.#model;
    const isLit =
      !model || model.hasLights || model.light.sources.length > 1 || this.#environment !== undefined;
    if (isLit) this.scene.remove(this.#studio);
    else this.scene.add(this.#studio);
  }
}

/** Metres from the camera to the farthest corner of a box. */
function farthest({ position }: Camera, { min, max }: Box): number {
  const reach = new Vector3(...min)
    .sub(position)
    .negate()
    .max(new Vector3(...max).sub(position));
  return Math.hypot(...reach.toArray().map(Math.abs), 0);
}
