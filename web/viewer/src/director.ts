/** Decides what the picture shows: from state and files to the options of a frame, and to what people read. */
import { isSamePose, type Pose } from "./camera/pose.js";
import type { Rig } from "./camera/rig.js";
import { startPose } from "./scene/model.js";
import type { Mover } from "./scene/mover.js";
import type { Stage } from "./scene/stage.js";
import { VIEWS, type ViewerState } from "./state/state.js";
import type { Status } from "./state/status.js";
import type { Store } from "./state/store.js";
import { type Frame, type FrameOptions, isLit, lightView, type Side } from "./view/frame.js";
import { choicesOf, resolveSides, type SideChoice } from "./view/sources.js";
import { type FrameTimes, statisticsOf } from "./view/statistics.js";
import { directText } from "./view/words.js";

/** Stops that nobody sees. */
const LEAST_EV = 0.01;

export interface DirectorOptions {
  readonly state: Store<ViewerState>;
  readonly status: Store<Status>;
  readonly stage: Stage;
  readonly rig: Rig;
  readonly mover: Mover;
  /** Draw again. */
  readonly onChange: () => void;
}

export class Director {
  readonly #options: DirectorOptions;

  constructor(options: DirectorOptions) {
    this.#options = options;
  }

  /**
   * A scene has been opened.
   *
   * @param isReplacement of a scene that the state spoke of
   */
  welcome(isReplacement: boolean): void {
    const { stage, rig, state } = this.#options;
    const { model } = stage;
    if (!model) return;
    rig.setModel(model.root, model.box);
    if (isReplacement) state.set({ camera: undefined, place: undefined });
    rig.pose = state.value.camera ?? startPose(model, stage.camera.aspect);
    this.placeObject();
    this.resolve();
  }

  /** The object stands where it was put, else in the middle of what the camera sees. */
  placeObject(): void {
    const { stage, state, mover, rig } = this.#options;
    const { object, place } = state.value;
    mover.show(object, stage.size);
    if (object !== "off") mover.place = place ?? rig.pose.target;
  }

  /** Finds out what the sides are, now that sources or wishes have changed. */
  resolve(): void {
    const { stage, state, status, onChange } = this.#options;
    const light = stage.model?.light;
    if (!light) return;
    const choices = choicesOf(light.sources, status.value.references);
    const [left, right] = resolveSides(choices, state.value.left, state.value.right);
    light.use(left?.kind === "light" ? left.id : "none");
    const possible = new Set<string | null>([null, ...light.views]);
    const views = VIEWS.filter((view) => possible.has(lightView(view)));
    status.set({ choices, left, right, views, direct: directText(light, stage.isStudio) });
    this.#comparePoses();
    onChange();
  }

  /** @returns whether there is more to move in the next frame */
  move(seconds: number): boolean {
    const goesOn = this.#options.rig.update(seconds);
    if (goesOn) this.#comparePoses();
    return goesOn;
  }

  draw(frame: Frame): void {
    const { stage, state } = this.#options;
    const options = this.#frameOptions();
    if (!options) return;
    stage.showProbes(isLit(options.view) ? state.value.probes : "off", options.ev);
    stage.fitDepth();
    frame.draw(stage.scene, stage.camera, options);
  }

  /** Draws again what was drawn last, without asking any source of light. */
  compose(frame: Frame): void {
    const options = this.#frameOptions();
    if (options) frame.compose(options);
  }

  /** What can be said of a picture at rest: its exposure, and how far its sides are apart. */
  async measure(frame: Frame): Promise<void> {
    const { status, onChange } = this.#options;
    const { isOpening } = status.value;
    const ev = await this.#exposure(frame);
    if (Math.abs(ev - status.value.ev) > LEAST_EV) {
      status.set({ ev });
      onChange();
      return; // the picture is drawn again, and measured
    }
    const options = this.#frameOptions();
    const isPair = options && options.compare !== "single";
    const difference = isPair ? await this.#alone(frame, () => frame.measure(options)) : undefined;
    status.set({ difference });
    this.#keepPose();
    if (status.value.phase === "loading" && !isOpening) status.set({ phase: "ready", message: "" });
  }

  /** @param size of the canvas, pixels */
  tell(times: FrameTimes, size: readonly [number, number]): void {
    const { stage, status } = this.#options;
    const { backend, left } = status.value;
    if (!stage.model || !backend) return;
    const source = stage.model.light.sources.find(({ name }) => name === left?.id);
    status.set({ statistics: statisticsOf(stage.model, source, times, backend, size) });
  }

  /** The camera of a picture of the manifest; where it has none, the file's of that number, or its first. */
  poseOfPicture(index: number): Pose | undefined {
    const { model, references } = this.#options.status.value;
    return references[index]?.pose ?? model?.cameras[index]?.pose ?? model?.cameras[0]?.pose;
  }

  /** Cameras of the file, then those of pictures. */
  poseOfNumber(index: number): Pose | undefined {
    const { model, references } = this.#options.status.value;
    const cameras = model?.cameras.map(({ pose }) => pose) ?? [];
    return [...cameras, ...references.flatMap(({ pose }) => pose ?? [])][index];
  }

  async #exposure(frame: Frame): Promise<number> {
    const { ev } = this.#options.state.value;
    const model = this.#options.stage.model;
    if (typeof ev === "number" || !model) return typeof ev === "number" ? ev : 0;
    const isTold = ev === "file" && model.light.baked?.lighting.lightmap !== undefined;
    return isTold ? model.light.exposure : this.#alone(frame, () => frame.meter());
  }

  /** Measures the scene alone, without what was only put into it; then draws the sides as they were. */
  #alone<T>(frame: Frame, measure: () => Promise<T>): Promise<T> {
    const { stage } = this.#options;
    const { guests } = stage;
    const options = this.#frameOptions();
    if (guests.length === 0 || !options) return measure();
    for (const guest of guests) guest.visible = false;
    try {
      frame.drawSides(stage.scene, stage.camera, options);
      return measure(); // what it reads is on its way before the next picture is drawn
    } finally {
      for (const guest of guests) guest.visible = true;
      frame.drawSides(stage.scene, stage.camera, options);
    }
  }

  #frameOptions(): FrameOptions | undefined {
    const { stage, state, status } = this.#options;
    const light = stage.model?.light;
    const { left, right, ev } = status.value;
    return light && { ...state.value, ev, light, left: this.#side(left), right: this.#side(right) };
  }

  #side(choice: SideChoice | undefined): Side {
    const reference = this.#options.status.value.references.find(({ id }) => id === choice?.id);
    if (reference) return { kind: "picture", picture: reference.picture };
    return { kind: "light", source: choice?.id ?? "none" };
  }

  /** Finds out whether a picture that is shown was taken from elsewhere. */
  #comparePoses(): void {
    const { status, state, rig } = this.#options;
    const { left, right, references } = status.value;
    const shown = [left, state.value.compare === "single" ? undefined : right];
    const isOffPose = references.some(
      ({ id, pose }) => pose && shown.some((side) => side?.id === id) && !isSamePose(pose, rig.pose),
    );
    status.set({ isOffPose });
  }

  /** Repeats in the state where the camera came to rest, unless that is where it would start. */
  #keepPose(): void {
    const { stage, state, status, rig } = this.#options;
    if (!stage.model || status.value.isOpening) return; // the next scene is not to be seen from here
    const known = state.value.camera ?? startPose(stage.model, stage.camera.aspect);
    if (!isSamePose(known, rig.pose)) state.set({ camera: rig.pose });
  }
}
