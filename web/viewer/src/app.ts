/** Puts everything together: a renderer that may come and go, the scene that stays, and the page. */
import { InputError, type TextureLimits, WEBGL2_LIMITS } from "@irradia/runtime";
import { limitsOf } from "@irradia/three/webgpu";
import type { WebGPURenderer } from "three/webgpu";
import { framePose, isSamePose, type Pose } from "./camera/pose.js";
import { Rig } from "./camera/rig.js";
import { Director } from "./director.js";
import { problemOf } from "./files/problem.js";
import { Loop } from "./loop.js";
import { startPose } from "./scene/model.js";
import { Mover } from "./scene/mover.js";
import { Stage } from "./scene/stage.js";
import { Session } from "./session.js";
import { Patience } from "./state/patience.js";
import type { PageOptions, ViewerState } from "./state/state.js";
import type { Status } from "./state/status.js";
import type { Store } from "./state/store.js";
import { Frame } from "./view/frame.js";
import { backendOf, makeRenderer } from "./view/renderer.js";

/** More pixels than this per pixel of layout are nothing that eyes see. */
const MOST_PIXEL_RATIO = 2;
/** A device that is lost more often than this within this time won't stay. */
const [MOST_LOSSES, LOSSES_MS] = [3, 30_000];

export class App {
  readonly session: Session;
  readonly #stage = new Stage();
  readonly #rig: Rig;
  readonly #director: Director;
  readonly #patience = new Patience(MOST_LOSSES, LOSSES_MS);
  #renderer: WebGPURenderer | undefined;
  #limits: TextureLimits = WEBGL2_LIMITS;
  #frame: Frame | undefined;
  #loop: Loop | undefined;
  #pixelRatio = 1;

  constructor(
    readonly host: HTMLElement,
    readonly state: Store<ViewerState>,
    readonly status: Store<Status>,
    readonly options: PageOptions,
  ) {
    const { camera } = this.#stage;
    const onChange = (): void => this.#loop?.invalidate();
    const onPlace = (place: ViewerState["place"]): void => state.set({ place });
    const mover = new Mover({ element: host, camera, onMove: onChange, onPlace });
    this.#rig = new Rig({ camera, element: host, isSmooth: !options.kiosk, onChange });
    this.#director = new Director({ state, status, stage: this.#stage, rig: this.#rig, mover, onChange });
    this.session = new Session({
      stage: this.#stage,
      mover,
      status,
      limits: () => this.#limits,
      onScene: (isReplacement) => this.#director.welcome(isReplacement),
      onPose: (pose) => this.lookFrom(pose),
      onLight: () => this.#director.resolve(),
    });
    this.#listen();
  }

  /** Gets a canvas and a GPU; again after the GPU was lost. */
  async start(): Promise<void> {
    const canvas = document.createElement("canvas");
    canvas.role = "img";
    canvas.ariaLabel = "The scene in its light";
    const renderer = await makeRenderer(canvas, this.options.backend);
    renderer.onDeviceLost = () => void this.#recover(renderer);
    this.#renderer = renderer;
    this.#limits = limitsOf(renderer);
    const frame = new Frame(renderer);
    this.#frame = frame;
    this.host.replaceChildren(canvas);
    this.status.set({ backend: backendOf(renderer) });
    this.#resize();
    this.#loop = new Loop({
      renderer,
      nFramesToSettle: this.options.kiosk ? 1 : 2,
      move: (seconds) => {
        if (this.#pixelRatio !== pixelRatio()) this.#resize();
        return this.#director.move(seconds);
      },
      draw: () => this.#director.draw(frame),
      measure: () => this.#director.measure(frame),
      onTime: (gpuMs, cpuMs) => this.#director.tell({ gpuMs, cpuMs }, [canvas.width, canvas.height]),
      onError: (error) => this.#fail(error),
    });
  }

  /** Resolves when what the state asks for is on the canvas. */
  async settled(): Promise<void> {
    await this.#loop?.settled();
  }

  /** The picture on the canvas as PNG. */
  async picture(): Promise<Blob> {
    if (this.#frame && this.#loop?.isDrawn) this.#director.compose(this.#frame);
    else if (this.#frame) this.#director.draw(this.#frame);
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
    const pose = this.#director.poseOfNumber(index);
    if (pose) this.lookFrom(pose);
  }

  /** Where the picture on either side was taken. */
  lookFromShown(): void {
    const { left, right, references } = this.status.value;
    const shown = references.find(({ id, pose }) => pose && (id === left?.id || id === right?.id));
    if (shown?.pose) this.lookFrom(shown.pose);
  }

  /** Where a picture of the manifest was taken. */
  lookFromPicture(index: number): void {
    const pose = this.#director.poseOfPicture(index);
    if (pose) this.lookFrom(pose);
    else this.frameAll();
  }

  frameAll(): void {
    const { model, camera } = this.#stage;
    if (model) this.lookFrom(framePose(model.box, camera.aspect));
  }

  home(): void {
    const { model, camera } = this.#stage;
    if (model) this.lookFrom(startPose(model, camera.aspect));
  }

  #listen(): void {
    this.state.watch(
      ({ navigation }) => navigation,
      (navigation) => {
        this.#rig.navigation = navigation;
      },
    );
    this.state.subscribe((now, before) => {
      const isOther = (key: keyof ViewerState): boolean => now[key] !== before[key];
      if (isOther("left") || isOther("right") || isOther("compare")) this.#director.resolve();
      if (isOther("object") || isOther("place")) this.#director.placeObject();
      if (isOther("camera")) this.#follow(now.camera);
      this.#loop?.invalidate();
    });
    new ResizeObserver(() => this.#resize()).observe(this.host);
  }

  /** @param pose undefined for the scene's own */
  #follow(pose: Pose | undefined): void {
    const { model, camera } = this.#stage;
    const wanted = pose ?? (model && startPose(model, camera.aspect));
    if (wanted && !isSamePose(wanted, this.#rig.pose)) this.#rig.pose = wanted;
  }

  #resize(): void {
    const { clientWidth, clientHeight } = this.host;
    const [width, height] = [Math.max(clientWidth, 1), Math.max(clientHeight, 1)];
    const ratio = pixelRatio();
    this.#pixelRatio = ratio;
    this.#renderer?.setPixelRatio(ratio);
    this.#renderer?.setSize(width, height, false);
    this.#frame?.setSize(Math.floor(width * ratio), Math.floor(height * ratio));
    this.#stage.setSize(width, height);
    this.#loop?.invalidate();
  }

  async #recover(lost: WebGPURenderer): Promise<void> {
    if (lost !== this.#renderer) return;
    const message = "The graphics device was lost. Starting again";
    this.status.set({ phase: "loading", message });
    this.#leave(lost);
    const before = this.#limits;
    try {
      if (!this.#patience.allows(performance.now())) throw lostTooOften();
      await this.start();
      if (isLess(this.#limits, before)) void this.session.reopen();
    } catch (error) {
      this.#fail(error);
    }
  }

  /** Frees what can still be freed of a device that is gone. */
  #leave(renderer: WebGPURenderer): void {
    this.#loop?.stop();
    const frame = this.#frame;
    this.#frame = this.#renderer = undefined;
    const free = async (): Promise<void> => {
      frame?.dispose();
      await renderer.dispose();
    };
    free().catch(() => {}); // then nothing is left to free
  }

  #fail(error: unknown): void {
    const problem = { ...problemOf(error, "the picture"), title: "Can't draw" };
    const { problems } = this.status.value;
    this.status.set({ problems: [...problems, problem], phase: "error", message: problem.finding });
  }
}

function lostTooOften(): InputError {
  const finding = `expected a graphics device that stays, lost it more than ${MOST_LOSSES} times in ${LOSSES_MS / 1000} s`;
  return new InputError(finding, "browser", "Reload the page; a smaller window or scene may help.");
}

/** Whether what was planned for a device may be too much for this one. */
function isLess(limits: TextureLimits, before: TextureLimits): boolean {
  return (Object.keys(limits) as (keyof TextureLimits)[]).some((key) => limits[key] < before[key]);
}

/** Of the display; another one when a window moves or a page is zoomed, of which nobody tells reliably. */
function pixelRatio(): number {
  return Math.min(window.devicePixelRatio, MOST_PIXEL_RATIO);
}
