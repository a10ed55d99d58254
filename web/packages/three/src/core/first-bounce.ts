/** Whence the first bounce of the file's lights comes, so that each counts once. */
import type { Light } from "three";
import type { DirectFrom } from "../types.js";
import type { FileLights } from "./file-lights.js";
import { LampLists, type Lamps } from "./lamps.js";
import type { Source } from "./sources.js";

export class FirstBounce {
  readonly #lights: FileLights;
  readonly #lists = new LampLists();

  constructor(lights: FileLights) {
    this.#lights = lights;
  }

  /** Of static meshes. */
  whence(source: Source): DirectFrom {
    if (source.hasDirectMap) return "map";
    if (source.kind !== "none" && source.quantity === "full") return "source";
    return this.#lacking(source).length > 0 ? "lights" : "none";
  }

  /** Lets those lights shine that the source in use needs. */
  shine(source: Source): void {
    this.#lights.shine(this.#shining(source));
  }

  /** What a mesh without a lightmap, lit by `own`, needs beside the lights that shine. */
  lamps(own: Source, inUse: Source): Lamps | undefined {
    return this.#lists.between(this.#lacking(own), this.#shining(inUse));
  }

  #shining(source: Source): readonly Light[] {
    return source.hasDirectMap ? this.#lights.live : this.#lacking(source);
  }

  /** Fields of indirect light leave out all lights; maps and probes only those that stayed live. */
  #lacking({ kind, quantity }: Source): readonly Light[] {
    if (kind === "field" && quantity === "indirect") return this.#lights.all;
    return kind === "none" || quantity === "indirect" ? this.#lights.live : [];
  }
}
