/** Lights of which the light on a thing is short, or has too much: evaluated by the thing's own material. */
import type { Light } from "three";

/** A light's first bounce to be added, or one to be taken away that three.js adds and baked light holds. */
export interface Lamp {
  readonly light: Light;
  readonly isTaken: boolean;
}

/** Without shadows. The same object for the same lamps, since materials are made by it. */
export class Lamps {
  constructor(readonly list: readonly Lamp[]) {}
}

/** Lists of lamps, each made once. */
export class LampLists {
  readonly #known = new Map<string, Lamps>();

  /**
   * What a thing needs so that each light's first bounce counts once.
   *
   * @param lacking lights whose first bounce the thing's source leaves out
   * @param shining lights that three.js adds
   * @returns undefined where nothing is missing
   */
  between(lacking: readonly Light[], shining: readonly Light[]): Lamps | undefined {
    const missing = lacking.filter((light) => !shining.includes(light));
    // What shines with shadows can't be taken away without knowing them.
    const doubled = shining.filter((light) => !lacking.includes(light) && !light.castShadow);
    const list = [
      ...missing.map((light) => ({ light, isTaken: false })),
      ...doubled.map((light) => ({ light, isTaken: true })),
    ];
    if (list.length === 0) return undefined;
    const key = list.map(({ light, isTaken }) => `${isTaken ? "-" : "+"}${light.id}`).join("");
    const lamps = this.#known.get(key) ?? new Lamps(list);
    this.#known.set(key, lamps);
    return lamps;
  }
}
