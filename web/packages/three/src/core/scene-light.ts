/** The light of one scene: which source each mesh shows, and how. */
import { type BakedLight, expect, type LightShader, lightmapShader } from "@irradia/runtime";
import type { Group, Light, Material, Mesh, Object3D, Texture } from "three";
import type { DirectFrom, LightSource, LitSurface, SceneLight, SourceKind, View } from "../types.js";
import type { FileLights } from "./file-lights.js";
import { type GridLight, type Painter, ScreenLight, type Shading } from "./painter.js";
import type { ShadowMask } from "./shadow-mask.js";
import { addedSource, directOf, noSource, type Source, sourceNamed, sourcesOf } from "./sources.js";
import { isMesh, looseSurface } from "./surfaces.js";
import { disposeTextures } from "./textures.js";
import { Wardrobe } from "./wardrobe.js";

const COMMON_VIEWS: readonly View[] = ["irradiance", "albedo", "normal", "depth", "lightmap-uv"];

/** What a loaded file is made of. */
export interface LoadedScene {
  readonly scene: Group;
  readonly baked: BakedLight | undefined;
  readonly surfaces: LitSurface[];
  readonly lights: FileLights;
  readonly mask: ShadowMask | undefined;
}

export class BakedSceneLight implements SceneLight {
  readonly baked: BakedLight | undefined;
  readonly scene: Group;
  readonly #painter: Painter;
  readonly #wardrobe: Wardrobe;
  readonly #lights: FileLights;
  readonly #mask: ShadowMask | undefined;
  readonly #surfaces: Map<Mesh, LitSurface>;
  readonly #ofFile: readonly Source[];
  #sources: Source[];
  #source: Source;
  #dynamic: Source | undefined;
  #view: View | null = null;
  #screen: ScreenLight | undefined;
  #isScreened = false;
  #grid: GridLight | undefined;
  #direct: LightShader | undefined;

  constructor({ scene, baked, surfaces, lights, mask }: LoadedScene, painter: Painter, first?: string) {
    this.baked = baked;
    this.scene = scene;
    this.#painter = painter;
    this.#wardrobe = new Wardrobe(painter);
    this.#lights = lights;
    this.#mask = mask;
    if (mask) painter.shadow(mask);
    this.#surfaces = new Map(surfaces.map((surface) => [surface.mesh, surface]));
    this.#ofFile = baked ? sourcesOf(baked, lights.nLive > 0, painter.limits) : [];
    this.#sources = [...this.#ofFile, noSource()];
    this.#source = first ? sourceNamed(this.#sources, first) : this.#best();
    this.#dynamic = this.#sources.find(isMobile);
    this.#apply();
  }

  get sources(): readonly LightSource[] {
    return this.#sources;
  }

  get source(): LightSource {
    return this.#source;
  }

  use(name: string): void {
    this.#source = sourceNamed(this.#sources, name);
    this.#apply();
  }

  add(name: string, shader: LightShader, kind: SourceKind = "field"): LightSource {
    const direct = directOf(this.baked, this.#painter.limits);
    const source = addedSource(name, kind, shader, direct);
    const old = this.#sources.find((other) => other.name === name);
    this.#sources = [...this.#sources.filter((other) => other !== old).slice(0, -1), source, this.#none()];
    if (this.#source === old) this.#source = source;
    if (this.#dynamic === old) this.#dynamic = isMobile(source) ? source : undefined;
    if (old) this.#apply();
    return source;
  }

  remove(name: string): void {
    const source = sourceNamed(this.#sources, name);
    expect(!this.#ofFile.includes(source) && name !== "none", "expected a source that was added", name);
    this.#sources = this.#sources.filter((other) => other !== source);
    if (this.#source === source) this.#source = this.#best();
    if (this.#dynamic === source) this.#dynamic = this.#sources.find(isMobile);
    this.#apply();
  }

  lit(object: Object3D): void {
    object.traverse((child) => {
      if (!isMesh(child) || this.#surfaces.get(child)?.isDynamic === false) return;
      const surface = looseSurface(child, true);
      this.#surfaces.set(child, surface);
      this.#wardrobe.dress(child, this.#shadingOf(surface));
    });
  }

  unlit(object: Object3D): void {
    object.traverse((child) => {
      if (!isMesh(child) || !this.#surfaces.get(child)?.isDynamic) return;
      this.#surfaces.delete(child);
      this.#wardrobe.undress(child);
    });
  }

  get dynamicSource(): string | null {
    return this.#dynamic?.name ?? null;
  }

  set dynamicSource(name: string | null) {
    const source = name === null ? undefined : sourceNamed(this.#sources, name);
    expect(!source || isMobile(source), "expected a source that needs no lightmap", `${name}`);
    this.#dynamic = source;
    this.#apply();
  }

  get view(): View | null {
    return this.#view;
  }

  set view(view: View | null) {
    this.#view = view;
    this.#apply();
  }

  get views(): readonly View[] {
    return [...COMMON_VIEWS, ...(Object.keys(this.#source.shader?.views ?? {}) as View[])];
  }

  get intensity(): number {
    return this.#painter.intensity;
  }

  set intensity(factor: number) {
    this.#painter.intensity = factor;
  }

  get exposure(): number {
    return this.baked?.lighting.lightmap?.exposure ?? 0;
  }

  get directFrom(): DirectFrom {
    const { kind, quantity, hasDirectMap } = this.#source;
    if (hasDirectMap) return "map";
    if (kind !== "none" && quantity === "full") return "source";
    const nLights = kind === "field" ? this.lights.length : this.#lights.nLive;
    return nLights > 0 ? "lights" : "none";
  }

  get screen(): Texture | null {
    return this.#isScreened ? (this.#screen?.texture ?? null) : null;
  }

  set screen(texture: Texture | null) {
    const wasScreened = this.#isScreened;
    this.#isScreened = texture !== null;
    if (texture) {
      // One for good, so that materials which read it are made once.
      this.#screen ??= new ScreenLight(texture);
      this.#screen.texture = texture;
      this.#painter.screenChanged(this.#screen);
    }
    if (this.#isScreened !== wasScreened) this.#apply();
  }

  get surfaces(): readonly LitSurface[] {
    return [...this.#surfaces.values()];
  }

  get lights(): readonly Light[] {
    return this.#lights.all;
  }

  get bytes(): number {
    const shaders = this.#sources.flatMap((source) => source.made);
    const textures = new Set(shaders.flatMap((shader) => shader.textures));
    const uniforms = new Set(shaders.flatMap((shader) => shader.uniforms));
    const ofTextures = [...textures].reduce((sum, { plan }) => sum + plan.nBytes, 0);
    const ofUniforms = [...uniforms].reduce((sum, { values }) => sum + values.byteLength, 0);
    const ofMask = this.#mask?.texture.image.data?.byteLength ?? 0;
    return ofTextures + ofUniforms + ofMask + (this.#grid?.nBytes ?? 0);
  }

  refresh(): void {
    this.#wardrobe.clear();
    this.#apply();
  }

  originalOf(material: Material): Material {
    return this.#wardrobe.originalOf(material);
  }

  dispose(): void {
    for (const { mesh } of this.#surfaces.values()) this.#wardrobe.undress(mesh);
    this.#wardrobe.clear();
    this.#grid?.dispose();
    for (const source of this.#sources) for (const shader of source.made) disposeTextures(shader);
    if (this.#direct) disposeTextures(this.#direct);
    this.#mask?.texture.dispose();
  }

  #none(): Source {
    return this.#sources.at(-1) ?? noSource();
  }

  /** What a page wants to see first. */
  #best(): Source {
    const order: SourceKind[] = ["directional", "lightmap", "field", "probes", "none"];
    const found = order.flatMap((kind) => this.#sources.filter((source) => source.kind === kind));
    return found[0] ?? this.#none();
  }

  #apply(): void {
    for (const surface of this.#surfaces.values()) {
      this.#wardrobe.dress(surface.mesh, this.#shadingOf(surface));
    }
    const { kind, quantity } = this.#source;
    // Fields of indirect light leave out all lights; maps and probes only those that stayed live.
    this.#lights.shine({
      baked: kind === "field" && this.directFrom === "lights",
      live: kind === "none" || quantity === "indirect",
    });
    this.#showGrid(kind === "three-probes");
  }

  #shadingOf({ rectangles, isDynamic }: LitSurface): Shading {
    const hasLightmap = rectangles.length > 0;
    const screen = this.#isScreened ? this.#screen : undefined;
    const { width, height } = this.baked?.lighting.lightmap ?? { width: 1, height: 1 };
    return {
      light: screen ?? this.#lightOf(hasLightmap, isDynamic),
      direct: screen && hasLightmap && this.#source.hasDirectMap ? this.#directMap() : undefined,
      view: this.#view,
      mask: hasLightmap ? this.#mask : undefined,
      lightmap: hasLightmap ? [width, height] : undefined,
    };
  }

  /** The file's map of direct light alone. */
  #directMap(): LightShader | undefined {
    const [map, entry] = [this.baked?.direct, this.baked?.lighting.direct];
    if (map && entry) this.#direct ??= lightmapShader(map, entry.scale, "full", this.#painter.limits);
    return this.#direct;
  }

  #lightOf(hasLightmap: boolean, isDynamic: boolean): LightShader | GridLight | undefined {
    if (this.#source.kind === "three-probes") return this.#threeGrid();
    if (hasLightmap) return this.#source.shader;
    if (this.#source.kind === "none") return undefined;
    return !isDynamic && this.#source.isDynamic ? this.#source.bare : this.#dynamic?.moving;
  }

  #threeGrid(): GridLight | undefined {
    const { probes } = this.baked ?? {};
    if (probes) this.#grid ??= this.#painter.probeGrid(probes);
    return this.#grid;
  }

  #showGrid(isShown: boolean): void {
    const grid = isShown ? this.#threeGrid()?.grid : undefined;
    if (grid) this.scene.add(grid);
    else this.#grid?.grid.removeFromParent();
  }
}

function isMobile(source: Source): boolean {
  return (source.kind === "field" || source.kind === "probes") && source.isDynamic;
}
