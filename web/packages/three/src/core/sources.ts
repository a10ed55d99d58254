/** Which sources of light a file holds, and how each is read. */
import {
  type BakedLight,
  directionalShader,
  expect,
  fieldShader,
  type LightInput,
  type LightShader,
  lightmapShader,
  type Precision,
  type Probes,
  probeShader,
  type Quantity,
  type TextureLimits,
  withDirect,
} from "@irradia/runtime";
import type { LightSource, SourceKind } from "../types.js";

/** Inputs that every surface has, with a lightmap or without. */
const EVERYWHERE: ReadonlySet<LightInput> = new Set<LightInput>(["position", "normal", "surfaceNormal"]);

/** How a source's shaders come about; each is made when first asked for. */
interface Making {
  /** Whether it needs no lightmap's uv; said here, so that nobody makes a shader in order to ask. */
  readonly isEverywhere?: boolean;
  readonly make?: (() => LightShader) | undefined;
  /** Adds the map of direct light, where that is missing. */
  readonly direct?: ((shader: LightShader) => LightShader) | undefined;
  /** For what moves, where that is read in another way. */
  readonly moving?: ((bare: LightShader) => LightShader) | undefined;
}

export class Source implements LightSource {
  readonly #making: Making;
  #bare: LightShader | undefined;
  #whole: LightShader | undefined;
  #moving: LightShader | undefined;

  constructor(
    readonly name: string,
    readonly kind: SourceKind,
    readonly quantity: Quantity,
    making: Making = {},
  ) {
    this.#making = { ...making, direct: quantity === "indirect" ? making.direct : undefined };
  }

  get bare(): LightShader | undefined {
    this.#bare ??= this.#making.make?.();
    return this.#bare;
  }

  get shader(): LightShader | undefined {
    const { bare } = this;
    this.#whole ??= bare && (this.#making.direct?.(bare) ?? bare);
    return this.#whole;
  }

  /** For what moves. */
  get moving(): LightShader | undefined {
    const { bare } = this;
    this.#moving ??= bare && (this.#making.moving?.(bare) ?? bare);
    return this.#moving;
  }

  get hasDirectMap(): boolean {
    return this.#making.direct !== undefined;
  }

  get isDynamic(): boolean {
    return this.#making.isEverywhere ?? false;
  }

  /** Shaders that were made. */
  get made(): LightShader[] {
    return [this.#bare, this.#whole, this.#moving].filter((shader) => shader !== undefined);
  }
}

/** A source of the page's own. */
export function addedSource(
  name: string,
  kind: SourceKind,
  shader: LightShader,
  direct: Making["direct"],
): Source {
  const isEverywhere = shader.inputs.every((input) => EVERYWHERE.has(input));
  const ofFields = kind === "field" ? direct : undefined;
  return new Source(name, kind, shader.quantity, { make: () => shader, direct: ofFields, isEverywhere });
}

/** The source that is always there. */
export function noSource(): Source {
  return new Source("none", "none", "full");
}

/**
 * The sources of a file, in the order of `SourceKind`.
 *
 * @param hasLiveLights whether first bounces of lights were left to the engine; a sun that was has no node
 * @param precision of the field's perceptron; floats by default
 */
export function sourcesOf(
  baked: BakedLight,
  hasLiveLights: boolean,
  limits: TextureLimits,
  precision?: Precision,
): Source[] {
  const { lighting, lightmap, directional, field, probes } = baked;
  const quantity = hasLiveLights ? "indirect" : (lighting.lightmap?.light ?? "full");
  const sources: Source[] = [];
  const add = (kind: SourceKind, light: Quantity, making: Making): void => {
    sources.push(new Source(kind, kind, light, making));
  };
  if (lightmap && lighting.lightmap) {
    const { scale } = lighting.lightmap;
    add("lightmap", quantity, { make: () => lightmapShader(lightmap, scale, quantity, limits) });
  }
  if (directional) add("directional", quantity, { make: () => directionalShader(baked, limits) });
  if (field) {
    const make = () => fieldShader(field, limits, { precision });
    add("field", field.frame.quantity, { make, direct: directOf(baked, limits), isEverywhere: true });
  }
  if (probes?.structure) {
    const make = () => probeShader(probes, limits);
    const moving = (bare: LightShader) => amongProbes(probes, bare, limits);
    add("probes", probes.light, { make, moving, isEverywhere: true });
  }
  if (probes?.structure?.kind === "grid") add("three-probes", probes.light, {});
  return sources;
}

/** Probes for what moves between them, by the textures that surfaces read. */
function amongProbes(probes: Probes, { textures }: LightShader, limits: TextureLimits): LightShader {
  return { ...probeShader(probes, limits, { lit: "things" }), textures };
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
