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
import type { Movable, Stage } from "./scene/stage.js";
import type { Status } from "./state/status.js";
import type { Store } from "./state/store.js";
import type { Reference } from "./view/sources.js";

/** What is in the way of a `.gltf` alone, or of nothing. */
const RESOURCES = /\.(bin|png|jpe?g|webp)$/i;

export interface SessionOptions {
  readonly stage: Stage;
  /** Is lit by each scene in turn. */
  readonly mover: Movable;
  readonly status: Store<Status>;
  readonly limits: () => TextureLimits;
  /** A scene was opened; `isFirst` is false where it took another's place. */
  readonly onScene: () => void;
  /** A file asks for a camera. */
  readonly onPose: (pose: Pose) => void;
  /** Sources, references or the environment changed. */
  readonly onLight: () => void;
}

export class Session {
  readonly #options: SessionOptions;

  constructor(options: SessionOptions) {
    this.#options = options;
  }

  /** Opens what was dropped together; problems are shown, not thrown. */
  async open(files: readonly NamedFile[]): Promise<void> {
    this.#options.status.set({ isOpening: true });
    await this.#openAll(files);
    this.finish();
  }

  async #openAll(files: readonly NamedFile[]): Promise<void> {
    const scene = files.find((file) => kindOf(file) === "scene");
    const others = files.filter((file) => file !== scene);
    const isGltf = scene?.name.toLowerCase().endsWith(".gltf") ?? false;
    const resources = isGltf ? others.filter(({ name }) => RESOURCES.test(name)) : [];
    if (scene) await this.#try(scene.name, () => this.#openScene(scene, resources));
    for (const file of others.filter((one) => !resources.includes(one))) {
      await this.#try(file.name, () => this.#openOther(file));
    }
  }

  /** Opens a manifest's scene with its fields and pictures; more may follow until `finish`. */
  async openManifest(entry: ManifestScene): Promise<void> {
    await this.#try(entry.name, async () => {
      await this.#openScene({ name: fileName(entry.url), bytes: await this.fetch(entry.url) }, []);
    });
    if (!this.#options.stage.model) return;
    for (const [index, field] of entry.fields.entries()) {
      await this.#try(field.name, async () => {
        const bytes = await this.fetch(field.url);
        await this.#addField({ name: fileName(field.url), bytes }, `field:${index}`);
      });
    }
    for (const picture of entry.references) await this.#try(picture.name, () => this.#openReference(picture));
  }

  /** Opens a file by its address, likewise. */
  async openUrl(url: string): Promise<void> {
    await this.#try(fileName(url), async () => {
      await this.#openAll([{ name: fileName(url), bytes: await this.fetch(url) }]);
    });
  }

  /** Nothing more is to come for now. An old scene stays where a new one can't be read. */
  finish(): void {
    const { status, stage } = this.#options;
    const { problems } = status.value;
    const phase = problems.length > 0 ? "error" : stage.model ? "loading" : "empty";
    const message = problems.at(-1)?.finding ?? "";
    status.set({ phase, message, progress: undefined, isOpening: false });
  }

  async fetch(url: string): Promise<Uint8Array> {
    return openFile(url, (received, total) => {
      this.#options.status.set({ progress: total > 0 ? received / total : undefined });
    });
  }

  async #try(name: string, work: () => Promise<void>): Promise<void> {
    const { status } = this.#options;
    status.set({ phase: "loading", message: `Reading ${name}`, progress: undefined });
    try {
      await work();
    } catch (error) {
      const problem = problemOf(error, name);
      status.set({ problems: [...status.value.problems, problem] });
    }
  }

  async #openScene(file: NamedFile, resources: readonly NamedFile[]): Promise<void> {
    const { stage, mover, status, limits, onScene } = this.#options;
    const model = await loadScene(file, resources, limits());
    stage.setModel(model, mover);
    status.set({ model, references: [], problems: [] });
    onScene();
  }

  async #openOther(file: NamedFile): Promise<void> {
    const kind = kindOf(file);
    if (kind === "field" || kind === "field-bin") return this.#addField(file, `field:${file.name}`);
    if (kind === "environment-or-picture") return this.#addRadiance(readRadiance(file));
    if (kind === "picture") return this.#addReference(await readPicture(file), undefined, file.name);
    if (kind === "camera") return this.#options.onPose(readCameraFile(file, this.#reach()));
    const fix =
      "It takes .glb, .gltf, fields (.safetensors, .zst, .bin), .hdr, .exr, .png, .jpg and cameras (.json).";
    throw new InputError("expected a file that the viewer knows, found another", file.name, fix);
  }

  async #addField(file: NamedFile, id: string): Promise<void> {
    const { stage, limits, onLight } = this.#options;
    addField(stage.model, await loadField(file), id, limits());
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

  async #openReference({ name, url, kind, ev, pose }: ManifestPicture): Promise<void> {
    const file = { name: fileName(url), bytes: await this.fetch(url) };
    const picture = kind === "hdr" ? readRadiance(file) : await readPicture(file, ev);
    this.#addReference(picture, pose, name);
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
