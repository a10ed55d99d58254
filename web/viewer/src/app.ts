/** Puts everything together: files to scene, state to picture, picture to page. */

import { WEBGL2_LIMITS } from "@irradia/runtime";
import { limitsOf } from "@irradia/three/webgpu";
import type { WebGPURenderer } from "three/webgpu";
import { framePose, isSamePose, type Pose } from "./camera/pose.js";
import { Rig } from "./camera/rig.js";
import { problemOf } from "./files/problem.js";
import { Loop } from "./loop.js";
import { startPose } from "./scene/model.js";
import { Mover } from "./scene/mover.js";
import { Stage } from "./scene/stage.js";
import { Session } from "./session.js";
import { type PageOptions, VIEWS, type ViewerState } from "./state/state.js";
import type { Status } from "./state/status.js";
import type { Store } from "./state/store.js";
import { Frame, type FrameOptions, lightView, type Side } from "./view/frame.js";
import { backendOf, makeRenderer } from "./view/renderer.js";
import { choicesOf, resolveSides, type SideChoice } from "./view/sources.js";
import { statisticsOf } from "./view/statistics.js";
import { directText } from "./view/words.js";

/** More pixels than this per pixel of layout are nothing that eyes see. */
const MOST_PIXEL_RATIO = 2;

export class App {
  readonly session: Session;
  readonly #stage = new Stage();
  readonly #rig: Rig;
  readonly #mover: Mover;
  #renderer: WebGPURenderer | undefined;
  #frame: Frame | undefined;
  #loop: Loop | undefined;
  #times = { gpuMs: undefined as number | undefined, cpuMs: 0 };

  constructor(
    readonly host: HTMLElement,
    readonly state: Store<ViewerState>,
    readonly status: Store<Status>,
    readonly options: PageOptions,
  ) {
    this.#mover = new Mover({
      element: host,
      camera: this.#stage.camera,
      onMove: () => this.#loop?.invalidate(),
      onPlace: (place) => state.set({ place }),
    });
    this.session = new Session({
      stage: this.#stage,
      mover: this.#mover,
      status,
      limits: () => (this.#renderer ? limitsOf(this.#renderer) : WEBGL2_LIMITS),
      onScene: () => this.#welcome(),
      onPose: (pose) => this.lookFrom(pose),
      onLight: () => this.#resolve(),
    });
    this.#rig = new Rig({
      camera: this.#stage.camera,
      element: host,
      isSmooth: !options.kiosk,
      onChange: () => this.#loop?.invalidate(),
    });
    this.#listen();
  }

  /** Gets a canvas and a GPU; again after the GPU was lost. */
  async start(): Promise<void> {
    const canvas = document.createElement("canvas");
    const renderer = await makeRenderer(canvas, this.options.backend);
    renderer.onDeviceLost = () => this.#recover();
    this.#renderer = renderer;
    this.#frame = new Frame(renderer);
    this.host.replaceChildren(canvas);
    this.status.set({ backend: backendOf(renderer) });
    this.#resize();
    this.#loop = new Loop({
      renderer,
      move: (seconds) => this.#move(seconds),
      draw: () => this.#draw(),
      measure: () => this.#measure(),
      onTime: (gpuMs, cpuMs) => this.#time(gpuMs, cpuMs),
      onError: (error) => this.#fail(error),
    });
  }

  /** Resolves when what the state asks for is on the canvas. */
  async settled(): Promise<void> {
    await this.#loop?.settled();
  }

  /** The picture on the canvas as PNG. */
  async picture(): Promise<Blob> {
    this.#draw();
    const canvas = this.#renderer?.domElement as HTMLCanvasElement;
    return new Promise((resolve, reject) => {
      canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("no picture"))), "image/png");
    });
  }

  lookFrom(pose: Pose): void {
    this.#rig.pose = pose;
    this.state.set({ camera: pose });
  }

  /** Cameras of the file first, then those of pictures. */
  lookFromNumber(index: number): void {
    const { model, references } = this.status.value;
    const cameras = model?.cameras.map(({ pose }) => pose) ?? [];
    const pictures = references.flatMap(({ pose }) => pose ?? []);
    const pose = [...cameras, ...pictures][index];
    if (pose) this.lookFrom(pose);
  }

  frameAll(): void {
    const { model } = this.#stage;
    if (model) this.lookFrom(framePose(model.box, this.#stage.camera.aspect));
  }

  home(): void {
    const { model } = this.#stage;
    if (model) this.lookFrom(startPose(model, this.#stage.camera.aspect));
  }

  #listen(): void {
    this.state.watch(
      ({ navigation }) => navigation,
      (navigation) => {
        this.#rig.navigation = navigation;
      },
    );
    this.state.subscribe((now, before) => {
      if (now.left !== before.left || now.right !== before.right) this.#resolve();
      if (now.object !== before.object || now.place !== before.place) this.#showObject();
      if (now.camera && now.camera !== before.camera && !isSamePose(now.camera, this.#rig.pose)) {
        this.#rig.pose = now.camera;
      }
      this.#loop?.invalidate();
    });
    new ResizeObserver(() => this.#resize()).observe(this.host);
  }

  #resize(): void {
    const { clientWidth, clientHeight } = this.host;
    const [width, height] = [Math.max(clientWidth, 1), Math.max(clientHeight, 1)];
    const ratio = Math.min(window.devicePixelRatio, MOST_PIXEL_RATIO);
    this.#renderer?.setPixelRatio(ratio);
    this.#renderer?.setSize(width, height);
    this.#frame?.setSize(Math.floor(width * ratio), Math.floor(height * ratio));
    this.#stage.setSize(width, height);
    this.#loop?.invalidate();
  }

  #welcome(): void {
    const { model } = this.#stage;
    if (!model) return;
    this.#rig.setModel(model.root, model.box);
    this.#rig.pose = this.state.value.camera ?? startPose(model, this.#stage.camera.aspect);
    this.#showObject();
    this.#resolve();
  }

  /** The object stands where it was put, else in the middle of what the camera sees. */
  #showObject(): void {
    const { object, place } = this.state.value;
    this.#mover.show(object, this.#stage.size);
    if (object !== "off") this.#mover.place = place ?? this.#rig.pose.target;
  }

  /** Finds out what the sides are, now that sources or wishes have changed. */
  #resolve(): void {
    const light = this.#stage.model?.light;
    if (!light) return;
    const choices = choicesOf(light.sources, this.status.value.references);
    const { left, right } = this.state.value;
    const [one, other] = resolveSides(choices, left, right);
    light.use(one?.kind === "light" ? one.id : "none");
    const possible = new Set<string | null>([null, ...light.views]);
    const views = VIEWS.filter((view) => possible.has(lightView(view)));
    const direct = directText(light, this.#stage.isStudio);
    this.status.set({ choices, left: one, right: other, views, direct });
    this.#loop?.invalidate();
  }

  #move(seconds: number): boolean {
    const before = this.#rig.pose;
    const goesOn = this.#rig.update(seconds);
    if (!isSamePose(before, this.#rig.pose)) this.status.set({ isOffPose: this.#isOffPose() });
    return goesOn;
  }

  #isOffPose(): boolean {
    const { left, right, references } = this.status.value;
    const shown = references.filter(
      ({ id }) => id === left?.id || (id === right?.id && this.state.value.compare !== "single"),
    );
    return shown.some(({ pose }) => pose && !isSamePose(pose, this.#rig.pose));
  }

  #draw(): void {
    const options = this.#frameOptions();
    if (!options) return;
    const { probes } = this.state.value;
    const isLit = options.view === "light" || options.view === "irradiance";
    this.#stage.showProbes(isLit ? probes : "off", options.ev);
    this.#stage.fitDepth();
    this.#frame?.draw(this.#stage.scene, this.#stage.camera, options);
  }

  #frameOptions(): FrameOptions | undefined {
    const light = this.#stage.model?.light;
    const { left, right, ev } = this.status.value;
    return light && { ...this.state.value, ev, light, left: this.#side(left), right: this.#side(right) };
  }

  #side(choice: SideChoice | undefined): Side {
    const reference = this.status.value.references.find(({ id }) => id === choice?.id);
    return reference
      ? { kind: "picture", picture: reference.picture }
      : { kind: "light", source: choice?.id ?? "none" };
  }

  async #measure(): Promise<void> {
    const { compare, ev: wanted } = this.state.value;
    const { model } = this.#stage;
    if (!model || !this.#frame) return;
    const told = wanted === "file" && model.light.baked?.lighting.lightmap ? model.light.exposure : undefined;
    const ev = typeof wanted === "number" ? wanted : (told ?? (await this.#frame.meter()));
    if (Math.abs(ev - this.status.value.ev) > 0.01) {
      this.status.set({ ev });
      this.#loop?.invalidate();
    }
    const options = this.#frameOptions();
    const difference = options && compare !== "single" ? await this.#frame.measure(options) : undefined;
    this.status.set({ difference });
    this.#keepPose();
    if (this.status.value.phase === "loading") this.status.set({ phase: "ready", message: "" });
  }

  /** Repeats in the state where the camera came to rest, unless that is where it would start. */
  #keepPose(): void {
    const { model } = this.#stage;
    const { camera } = this.state.value;
    const { pose } = this.#rig;
    const known = camera ?? (model && startPose(model, this.#stage.camera.aspect));
    if (!known || !isSamePose(known, pose)) this.state.set({ camera: pose });
  }

  #time(gpuMs: number | undefined, cpuMs: number): void {
    this.#times = { gpuMs, cpuMs };
    const { model } = this.#stage;
    const { backend, left } = this.status.value;
    if (!model || !backend) return;
    const source = model.light?.sources.find(({ name }) => name === left?.id);
    const { width, height } = this.#renderer?.domElement ?? { width: 0, height: 0 };
    this.status.set({ statistics: statisticsOf(model, source, this.#times, backend, [width, height]) });
  }

  async #recover(): Promise<void> {
    this.status.set({ phase: "loading", message: "The graphics device was lost. Starting again" });
    this.#loop?.stop();
    this.#frame = undefined;
    try {
      await this.start();
    } catch (error) {
      this.#fail(error);
    }
  }

  #fail(error: unknown): void {
    const problem = { ...problemOf(error, "the picture"), title: "Can't draw" };
    this.status.set({
      problems: [...this.status.value.problems, problem],
      phase: "error",
      message: problem.finding,
    });
  }
}
