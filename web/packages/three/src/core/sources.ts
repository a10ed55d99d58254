/** Which sources of light a file holds, and how each is read. */
import {
  type BakedLight,
  directionalShader,
  expect,
  fieldShader,
  type LightShader,
  lightmapShader,
  type Probes,
  probeShader,
  type Quantity,
  type TextureLimits,
  withDirect,
} from "@irradia/runtime";
import type { LightSource, SourceKind } from "../types.js";

/** Inputs that every point in space has. */
const EVERYWHERE = new Set(["position", "normal"]);

/** A source, with the shader that static meshes get: with the map of direct light where that is missing. */
export class Source implements LightSource {
  readonly #make: (() => LightShader) | undefined;
  readonly #direct: ((shader: LightShader) => LightShader) | undefined;
  #bare: LightShader | undefined;
  #whole: LightShader | undefined;

  constructor(
    readonly name: string,
    readonly kind: SourceKind,
    readonly quantity: Quantity,
    make?: () => LightShader,
    direct?: (shader: LightShader) => LightShader,
  ) {
    this.#make = make;
    this.#direct = quantity === "indirect" ? direct : undefined;
  }

  /** As it is, for what moves. */
  get bare(): LightShader | undefined {
    this.#bare ??= this.#make?.();
    return this.#bare;
  }

  get shader(): LightShader | undefined {
    const { bare } = this;
    this.#whole ??= bare && this.#direct ? this.#direct(bare) : bare;
    return this.#whole;
  }

  get hasDirectMap(): boolean {
    return this.#direct !== undefined;
  }

  get isDynamic(): boolean {
    return this.bare?.inputs.every((input) => EVERYWHERE.has(input)) ?? false;
  }

  /** Shaders that were made. */
  get made(): LightShader[] {
    return [this.#bare, this.#whole].filter((shader) => shader !== undefined);
  }
}

/** The source that is always there. */
export function noSource(): Source {
  return new Source("none", "none", "full");
}

/**
 * The sources of a file, in the order of `SourceKind`.
 *
 * @param hasLiveLights whether first bounces of lights were left to the engine
 */
export function sourcesOf(baked: BakedLight, hasLiveLights: boolean, limits: TextureLimits): Source[] {
  const { lighting, lightmap, directional, field, probes } = baked;
  const quantity = hasLiveLights ? "indirect" : "full";
  const sources: Source[] = [];
  const add = (kind: SourceKind, light: Quantity, make?: () => LightShader, hasDirect = false): void => {
    sources.push(new Source(kind, kind, light, make, hasDirect ? directOf(baked, limits) : undefined));
  };
  if (lightmap && lighting.lightmap) {
    const { scale } = lighting.lightmap;
    add("lightmap", quantity, () => lightmapShader(lightmap, scale, quantity, limits));
  }
  if (directional) add("directional", quantity, () => directionalShader(baked, limits));
  if (field) add("field", field.frame.quantity, () => fieldShader(field, limits), true);
  if (probes) {
    add("probes", probes.light, () => probeShader(probes, limits));
    if (hasGrid(probes)) add("three-probes", probes.light);
  }
  return sources;
}

/** Whether three.js' LightProbeGrid can hold them. */
export function hasGrid(probes: Probes): boolean {
  return probes.structure?.kind === "grid";
}

/** How the file's map of direct light is added to a source; undefined where it has none. */
export function directOf(
  baked: BakedLight | undefined,
  limits: TextureLimits,
): ((shader: LightShader) => LightShader) | undefined {
  const [map, entry] = [baked?.direct, baked?.lighting.direct];
  if (!map || !entry) return undefined;
  return (shader) => withDirect(shader, map, entry.scale, limits);
}

/** The source of a name. */
export function sourceNamed(sources: readonly Source[], name: string): Source {
  const found = sources.find((source) => source.name === name);
  const names = sources.map((source) => `'${source.name}'`).join(", ");
  expect(found !== undefined, `expected one of ${names}, found '${name}'`, "source of light");
  return found;
}
