/** Punctual lights of a file: those that the bake left to the engine, and those whose light is baked. */
import { EXTENSION, type NodeLight } from "@irradia/runtime";
import type { Light, Object3D } from "three";
import type { GLTFParser } from "three/addons/loaders/GLTFLoader.js";

const PUNCTUAL = "KHR_lights_punctual";

interface NodeDefinition {
  extensions?: Record<string, { light?: number; bakedLight?: number }>;
}

/**
 * Puts baked lights back on their nodes in the document, before GLTFLoader reads it, so that it makes them like
 * the others. Returns the nodes.
 *
 * @param nLights how many lights the document defines
 */
export function restoreBakedLights(nodes: readonly NodeDefinition[], nLights: number): ReadonlySet<number> {
  const restored = new Set<number>();
  nodes.forEach(({ extensions }, index) => {
    const light = extensions?.[EXTENSION]?.bakedLight;
    const isThere = Number.isInteger(light) && Number(light) >= 0 && Number(light) < nLights;
    if (!extensions || extensions[PUNCTUAL] || !isThere) return;
    extensions[PUNCTUAL] = { light: Number(light) };
    restored.add(index);
  });
  return restored;
}

export class FileLights {
  readonly #live: Light[] = [];
  readonly #baked: Light[] = [];
  readonly #channels = new Map<Light, number>();

  /**
   * @param restored nodes whose light is baked
   * @param nodes what the extension says of nodes
   */
  constructor(
    scene: Object3D,
    parser: GLTFParser,
    restored: ReadonlySet<number>,
    nodes: ReadonlyMap<number, NodeLight>,
  ) {
    const visit = (object: Object3D, above: number): void => {
      const node = parser.associations.get(object)?.nodes ?? above;
      if ((object as Light).isLight) {
        (restored.has(node) ? this.#baked : this.#live).push(object as Light);
        const channel = nodes.get(node)?.shadowMaskChannel;
        if (channel !== undefined) this.#channels.set(object as Light, channel);
      }
      for (const child of object.children) visit(child, node);
    };
    visit(scene, -1);
    for (const light of this.#baked) light.visible = false;
  }

  /** Channel of the shadow mask, by light that has one. */
  get maskChannels(): ReadonlyMap<Light, number> {
    return this.#channels;
  }

  get all(): readonly Light[] {
    return [...this.#live, ...this.#baked];
  }

  /** Those that the bake left live. */
  get live(): readonly Light[] {
    return this.#live;
  }

  /** Lets these shine, and no others. */
  shine(lights: readonly Light[]): void {
    for (const light of this.all) light.visible = lights.includes(light);
  }
}
