/** The plugin of GLTFLoader. */
import { type BakedLight, EXTENSION } from "@irradia/runtime";
import type { GLTF, GLTFLoaderPlugin, GLTFParser } from "three/addons/loaders/GLTFLoader.js";
import type { IrradiaOptions, IrradiaPlugin } from "../types.js";
import { FileLights, restoreBakedLights } from "./file-lights.js";
import type { Painter } from "./painter.js";
import { readBaked } from "./read.js";
import { BakedSceneLight } from "./scene-light.js";
import { readShadowMask } from "./shadow-mask.js";
import { surfacesOf } from "./surfaces.js";
import { readValidity } from "./validity.js";

/** A plugin that paints so. */
export function pluginOf(options: IrradiaOptions, newPainter: () => Painter): IrradiaPlugin {
  return (parser) => new LightingPlugin(parser, options, newPainter);
}

class LightingPlugin implements GLTFLoaderPlugin {
  readonly name = EXTENSION;
  readonly #parser: GLTFParser;
  readonly #options: IrradiaOptions;
  readonly #newPainter: () => Painter;
  readonly #restored: ReadonlySet<number>;
  #reading: Promise<BakedLight | undefined> | undefined;

  constructor(parser: GLTFParser, options: IrradiaOptions, newPainter: () => Painter) {
    this.#parser = parser;
    this.#options = options;
    this.#newPainter = newPainter;
    const { extensions, materials, nodes } = parser.json;
    const isBaked = extensions?.[EXTENSION] !== undefined;
    if (isBaked) takeOffLightmaps(objectsIn(materials));
    const nLights = objectsIn(extensions?.KHR_lights_punctual?.lights).length;
    this.#restored = isBaked ? restoreBakedLights(objectsIn(nodes), nLights) : new Set();
  }

  /** Light is read while the scene loads. */
  beforeRoot(): null {
    this.#reading = readBaked(this.#parser, this.#options.maxBytes);
    this.#reading.catch(() => {}); // reported by afterRoot
    return null;
  }

  async afterRoot(gltf: GLTF): Promise<void> {
    const baked = await this.#reading;
    const { scene } = gltf;
    const surfaces = surfacesOf(scene, this.#parser, baked);
    const lights = new FileLights(scene, this.#parser, this.#restored, baked?.nodes ?? new Map());
    const [mask, validity] = await Promise.all([
      readShadowMask(baked, lights.maskChannels),
      readValidity(baked),
    ]);
    const loaded = { scene, baked, surfaces, lights, mask, validity };
    gltf.userData.irradia = new BakedSceneLight(loaded, this.#newPainter(), this.#options.source);
  }
}

/** The lightmaps for loaders that don't know us, which another plugin might read: their light is ours already. */
function takeOffLightmaps(materials: readonly { extensions?: Record<string, unknown> }[]): void {
  for (const { extensions } of materials) if (extensions) delete extensions.MOZ_lightmap;
}

/** An array as long as it is one of objects; of anything else GLTFLoader will complain. */
function objectsIn<T extends object>(list: readonly T[] | undefined): readonly T[] {
  const isList = Array.isArray(list) && list.every((item) => typeof item === "object" && item !== null);
  return isList ? list : [];
}
