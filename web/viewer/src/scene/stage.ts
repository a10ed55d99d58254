/** The scene graph: the model, the sky, a light for scenes without any, and the camera. */
import { HemisphereLight, PerspectiveCamera, Scene, type Texture } from "three/webgpu";
import { DEFAULT_YFOV_DEG } from "../camera/pose.js";
import { disposeModel, type Model } from "./model.js";

/** W·m⁻² from above; enough to see shapes by. */
const STUDIO_INTENSITY = 3;

export class Stage {
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(DEFAULT_YFOV_DEG, 1, 0.01, 1000);
  readonly #studio = new HemisphereLight(0xffffff, 0x55504a, STUDIO_INTENSITY);
  #model: Model | undefined;
  #environment: Texture | undefined;

  get model(): Model | undefined {
    return this.#model;
  }

  /** Whether the studio's light shines, as nothing else does. */
  get isStudio(): boolean {
    return this.#studio.parent !== null;
  }

  /** Takes the place of the model before, which is freed. */
  setModel(model: Model): void {
    if (this.#model) {
      this.scene.remove(this.#model.root);
      disposeModel(this.#model);
    }
    this.#model = model;
    this.scene.add(model.root);
    this.#light();
  }

  setEnvironment(texture: Texture | undefined): void {
    this.#environment?.dispose();
    this.#environment = texture;
    this.scene.environment = this.scene.background = texture ?? null;
    this.#light();
  }

  setSize(width: number, height: number): void {
    this.camera.aspect = width / Math.max(height, 1);
    this.camera.updateProjectionMatrix();
  }

  #light(): void {
    const model = this.#model;
    const isLit =
      !model || model.hasLights || model.light.baked !== undefined || this.#environment !== undefined;
    if (isLit) this.scene.remove(this.#studio);
    else this.scene.add(this.#studio);
  }
}
