/** Opens files, one after another, and keeps what came of them. */
import { InputError, type TextureLimits } from "@irradia/runtime";
import { diagonal, type Pose } from "./camera/pose.js";
import { openFile } from "./files/bytes.js";
import { readCameraFile } from "./files/camera-file.js";
import { fileName, isPanorama, kindOf, type NamedFile } from "./files/kinds.js";
import { addField, loadField } from "./files/load-field.js";
import { loadScene } from "./files/load-scene.js";
import type { ManifestPicture, ManifestScene } from "./files/manifest.js";
import { environmentOf, type Picture, readPicture, readRadiance } from "./files/picture.js";
import { problemOf } from "./files/problem.js";
import { disposeModel } from "./scene/model.js";
import type { Movable, Stage } from "./scene/stage.js";
import { Queue } from "./state/queue.js";
import type { Status } from "./state/status.js";
import type { Store } from "./state/store.js";
import type { Reference } from "./view/sources.js";

/** What is in the way of a `.gltf` alone, or of nothing. */
const RESOURCES = /\.(bin|png|jpe?g|webp)$/i;

/** @param isAgain whether it has been done before, on another device */
type Step = (signal: AbortSignal, isAgain: boolean) => Promise<void>;

export interface SessionOptions {
  readonly stage: Stage;
  /** Is lit by each scene in turn. */
  readonly mover: Movable;
  readonly status: Store<Status>;
  readonly limits: () => TextureLimits;
  /** A scene was opened; dropped in place of another, it isn't what the camera was meant for. */
  readonly onScene: (isReplacement: boolean) => void;
  /** A file asks for a camera. */
  readonly onPose: (pose: Pose) => void;
  /** Sources, references or the environment changed. */
  readonly onLight: () => void;
}

export class Session {
  readonly #options: SessionOptions;
  readonly #queue = new Queue(() => this.#finish());
  /** What led to the scene as it is, so that it can be done again. */
  #steps: Step[] = [];

  constructor(options: SessionOptions) {
    this.#options = options;
  }

  /**
   * Opens what was dropped together; problems are shown, not thrown.
   *
   * @param read gives its bytes
   */
  open(read: () => Promise<readonly NamedFile[]>): Promise<void> {
    const { stage, status } = this.#options;
    return this.#add(async (signal, isAgain) => {
      status.set({ problems: [] });
      const isReplacement = stage.model !== undefined && !isAgain;
      await this.#try("the files", signal, async () => this.#openAll(await read(), signal, isReplacement));
    });
  }

  /** Opens a manifest's scene with its fields and pictures, in place of all that is being opened. */
  openManifest(entry: ManifestScene): Promise<void> {
    this.#queue.abandon();
    return this.#add((signal) => this.#openManifest(entry, signal));
  }

  /** Opens a scene by its address, likewise. */
  openScene(url: string): Promise<void> {
    this.#queue.abandon();
    return this.openUrl(url);
  }

  /** Opens a file by its address, beside what there is. */
  openUrl(url: string): Promise<void> {
    return this.#add((signal) =>
      this.#try(fileName(url), signal, async () => {
        const bytes = await this.#fetch(url, signal);
        await this.#openAll([{ name: fileName(url), bytes }], signal, false);
      }),
    );
  }

  /** Does something when all that was asked for before is done. */
  after(work: () => void): Promise<void> {
    return this.#queue.add(async () => work());
  }

  /** Takes off a field that was opened by its address. */
  closeField(url: string): Promise<void> {
    return this.after(() => {
      const { model } = this.#options.stage;
      const id = fieldId(fileName(url));
      if (!model?.fields.delete(id)) return;
      model.fieldBytes.delete(id);
      model.light.remove(id);
      this.#options.onLight();
    });
  }

  closeEnvironment(): Promise<void> {
    return this.after(() => {
      this.#options.stage.setEnvironment(undefined);
      this.#options.onLight();
    });
  }

  /** Opens all again that the scene was made of, for a device with other limits. */
  reopen(): Promise<void> {
    const steps = this.#steps;
    this.#steps = [];
    return Promise.all(steps.map((step) => this.#add(step, true))).then(() => {});
  }

  #add(step: Step, isAgain = false): Promise<void> {
    this.#options.status.set({ isOpening: true });
    return this.#queue.add(async (signal) => {
      this.#steps.push(step);
      await step(signal, isAgain);
    });
  }

  /** Nothing more is to come for now. An old scene stays where a new one can't be read. */
  #finish(): void {
    const { status, stage } = this.#options;
    const { problems } = status.value;
    const phase = problems.length > 0 ? "error" : stage.model ? "loading" : "empty";
    const message = problems.at(-1)?.finding ?? "";
    status.set({ phase, message, progress: undefined, isOpening: false });
    this.#options.onLight(); // draws, and so tells when what was opened is on the canvas
  }

  async #openAll(files: readonly NamedFile[], signal: AbortSignal, isReplacement: boolean): Promise<void> {
    const scene = files.find((file) => kindOf(file) === "scene");
    const others = files.filter((file) => file !== scene);
    const isGltf = scene?.name.toLowerCase().endsWith(".gltf") ?? false;
    const resources = isGltf ? others.filter(({ name }) => RESOURCES.test(name)) : [];
    if (scene) {
      await this.#try(scene.name, signal, () => this.#openScene(scene, resources, signal, isReplacement));
    }
    for (const file of others.filter((one) => !resources.includes(one))) {
      await this.#try(file.name, signal, () => this.#openOther(file, signal));
    }
  }

  async #openManifest(entry: ManifestScene, signal: AbortSignal): Promise<void> {
    const { stage } = this.#options;
    const before = stage.model;
    await this.#try(entry.name, signal, async () => {
      const bytes = await this.#fetch(entry.url, signal);
      await this.#openScene({ name: fileName(entry.url), bytes }, [], signal, false);
    });
    if (stage.model === before) return; // these fields and pictures are of a scene that isn't there
    for (const [index, field] of entry.fields.entries()) {
      await this.#try(field.name, signal, async () => {
        const bytes = await this.#fetch(field.url, signal);
        await this.#addField({ name: fileName(field.url), bytes }, `field:${index}`, signal);
      });
    }
    for (const picture of entry.references) {
      await this.#try(picture.name, signal, () => this.#openReference(picture, signal));
    }
  }

  async #fetch(url: string, signal: AbortSignal): Promise<Uint8Array> {
    const onProgress = (received: number, total: number): void =>
      this.#options.status.set({ progress: total > 0 ? received / total : undefined });
    const bytes = await openFile(url, { signal, onProgress });
    signal.throwIfAborted();
    return bytes;
  }

  async #try(name: string, signal: AbortSignal, work: () => Promise<void>): Promise<void> {
    if (signal.aborted) return;
    const { status } = this.#options;
    status.set({ phase: "loading", message: `Reading ${name}`, progress: undefined });
    try {
      await work();
    } catch (error) {
      if (!signal.aborted) status.set({ problems: [...status.value.problems, problemOf(error, name)] });
    }
  }

  async #openScene(
    file: NamedFile,
    resources: readonly NamedFile[],
    signal: AbortSignal,
    isReplacement: boolean,
  ): Promise<void> {
    const { stage, mover, status, limits, onScene } = this.#options;
    const model = await loadScene(file, resources, limits());
    if (signal.aborted) return disposeModel(model);
    stage.setModel(model, mover);
    for (const { picture } of status.value.references) picture.texture.dispose();
    this.#steps = this.#steps.slice(-1);
    status.set({ model, references: [], problems: [] });
    onScene(isReplacement);
  }

  async #openOther(file: NamedFile, signal: AbortSignal): Promise<void> {
    const kind = kindOf(file);
    if (kind === "field" || kind === "field-bin") return this.#addField(file, fieldId(file.name), signal);
    if (kind === "environment-or-picture") return this.#addRadiance(readRadiance(file));
    if (kind === "picture") return this.#addPicture(await readPicture(file), undefined, file.name, signal);
    if (kind === "camera") return this.#options.onPose(readCameraFile(file, this.#reach()));
    if (kind === "scene") {
      throw new InputError("expected one scene, found another", file.name, "Drop them one after the other.");
    }
    const fix =
      "It takes .glb, .gltf, fields (.safetensors, .zst, .bin), .hdr, .exr, .png, .jpg and cameras (.json).";
    throw new InputError("expected a file that the viewer knows, found another", file.name, fix);
  }

  async #addField(file: NamedFile, id: string, signal: AbortSignal): Promise<void> {
    const { stage, limits, onLight } = this.#options;
    const field = await loadField(file);
    signal.throwIfAborted();
    addField(stage.model, field, id, limits());
    onLight();
  }

  #addRadiance(picture: Picture): void {
    const { stage, onLight } = this.#options;
    if (isPanorama(picture.width, picture.height)) {
      stage.setEnvironment(environmentOf(picture));
      onLight();
    } else {
      this.#addReference(picture, undefined, picture.name);
    }
  }

  async #openReference({ name, url, kind, ev, pose }: ManifestPicture, signal: AbortSignal): Promise<void> {
    const file = { name: fileName(url), bytes: await this.#fetch(url, signal) };
    const picture = kind === "hdr" ? readRadiance(file) : await readPicture(file, ev);
    this.#addPicture(picture, pose, name, signal);
  }

  #addPicture(picture: Picture, pose: Pose | undefined, label: string, signal: AbortSignal): void {
    signal.throwIfAborted();
    this.#addReference(picture, pose, label);
  }

  #addReference(picture: Picture, pose: Pose | undefined, label: string): void {
    const { status, onLight } = this.#options;
    const { references } = status.value;
    const id = references.length === 0 ? "reference" : `reference:${references.length}`;
    const reference: Reference = { id, label, picture, pose };
    status.set({ references: [...references, reference] });
    onLight();
  }

  #reach(): number {
    const { model } = this.#options.stage;
    return model ? diagonal(model.box) / 2 : 1;
  }
}

/** The source's id that a field gets by the name of its file. */
function fieldId(name: string): string {
  return `field:${name}`;
}
