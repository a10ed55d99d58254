/** The light of one scene: which source each mesh shows, and how. */
import { type BakedLight, expect, type LightShader, lightmapShader } from "@irradia/runtime";
import type { DataArrayTexture, Group, Light, Material, Mesh, Object3D, Texture } from "three";
import type {
  DirectFrom,
  LightSource,
  LitSurface,
  SceneLight,
  Shown,
  SourceKind,
  SurfacesAs,
  View,
} from "../types.js";
import type { FileLights } from "./file-lights.js";
import { FirstBounce } from "./first-bounce.js";
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
  readonly validity: DataArrayTexture | undefined;
}

export class BakedSceneLight implements SceneLight {
  readonly baked: BakedLight | undefined;
  readonly scene: Group;
  readonly #painter: Painter;
  readonly #wardrobe: Wardrobe;
  readonly #lights: FileLights;
  readonly #firstBounce: FirstBounce;
  readonly #mask: ShadowMask | undefined;
  readonly #unshadow: (() => void) | undefined;
  readonly #validity: DataArrayTexture | undefined;
  readonly #surfaces: Map<Mesh, LitSurface>;
  readonly #ofFile: readonly Source[];
  #sources: Source[];
  #source: Source;
  #dynamic: Source | undefined;
  #view: View | null = null;
  #screen: ScreenLight | undefined;
  #surfacesAs: SurfacesAs = "materials";
  #isScreened = false;
  #version = 0;
  #wasValidityShown = false;
  #grid: GridLight | undefined;
  #direct: LightShader | undefined;

  constructor(loaded: LoadedScene, painter: Painter, first?: string) {
    const { scene, baked, surfaces, lights, mask, validity } = loaded;
    this.baked = baked;
    this.scene = scene;
    this.#painter = painter;
    this.#wardrobe = new Wardrobe(painter);
    this.#lights = lights;
    this.#firstBounce = new FirstBounce(lights);
    this.#mask = mask;
    this.#validity = validity;
    this.#unshadow = mask && painter.shadow(mask);
    this.#surfaces = new Map(surfaces.map((surface) => [surface.mesh, surface]));
    this.#ofFile = baked ? sourcesOf(baked, lights.live.length > 0, painter.limits, painter.precision) : [];
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

  show(changes: Partial<Shown>): void {
    const next = { ...this.#shown, ...changes };
    const source = sourceNamed(this.#sources, next.source);
    const dynamic = next.dynamicSource === null ? undefined : sourceNamed(this.#sources, next.dynamicSource);
    expect(!dynamic || isMobile(dynamic), "expected a source that needs no lightmap", `${dynamic?.name}`);
    const { surfacesAs } = next;
    expect(["materials", "baked"].includes(surfacesAs), "expected 'materials' or 'baked'", `${surfacesAs}`);
    const before = [this.#source, this.#dynamic, this.#view, this.#isScreened, this.#surfacesAs];
    this.#source = source;
    this.#dynamic = dynamic;
    this.#view = next.view;
    this.#surfacesAs = surfacesAs;
    this.#setScreen(next.screen);
    const after = [this.#source, this.#dynamic, this.#view, this.#isScreened, this.#surfacesAs];
    if (after.some((each, i) => each !== before[i])) this.#apply();
  }

  use(name: string): void {
    this.show({ source: name });
  }

  add(name: string, shader: LightShader, kind: SourceKind = "field"): LightSource {
    expect(name !== "none", "expected another name, since 'none' is always there", "source of light");
    const direct = directOf(this.baked, this.#painter.limits);
    const source = addedSource(name, kind, shader, direct);
    const old = this.#sources.find((other) => other.name === name);
    this.#sources = [...this.#sources.filter((other) => other !== old).slice(0, -1), source, this.#none()];
    if (this.#source === old) this.#source = source;
    if (old && this.#dynamic === old) this.#dynamic = isMobile(source) ? source : undefined;
    if (old) {
      this.#apply();
      this.#free(old);
    }
    return source;
  }

  remove(name: string): void {
    const source = sourceNamed(this.#sources, name);
    expect(!this.#ofFile.includes(source) && name !== "none", "expected a source that was added", name);
    this.#sources = this.#sources.filter((other) => other !== source);
    if (this.#source === source) this.#source = this.#best();
    if (this.#dynamic === source) this.#dynamic = this.#sources.find(isMobile);
    this.#apply();
    this.#free(source);
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
    this.show({ dynamicSource: name });
  }

  get view(): View | null {
    return this.#view;
  }

  set view(view: View | null) {
    this.show({ view });
  }

  get surfacesAs(): SurfacesAs {
    return this.#surfacesAs;
  }

  set surfacesAs(surfacesAs: SurfacesAs) {
    this.show({ surfacesAs });
  }

  get views(): readonly View[] {
    const ofShader = Object.keys(this.#source.shader?.views ?? {}) as View[];
    return [...COMMON_VIEWS, ...ofShader, ...(this.#shownValidity ? (["validity"] as const) : [])];
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
    return this.#firstBounce.whence(this.#source);
  }

  get screen(): Texture | null {
    return this.#isScreened ? (this.#screen?.texture ?? null) : null;
  }

  set screen(texture: Texture | null) {
    this.show({ screen: texture });
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
    const images = [this.#mask?.texture, this.#wasValidityShown ? this.#validity : undefined];
    const ofImages = images.reduce((sum, texture) => sum + (texture?.image.data?.byteLength ?? 0), 0);
    return ofTextures + ofUniforms + ofImages + (this.#grid?.nBytes ?? 0);
  }

  get version(): number {
    return this.#version;
  }

  refresh(): void {
    this.#version += 1;
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
    this.#unshadow?.();
    this.#mask?.texture.dispose();
    this.#validity?.dispose();
  }

  get #shown(): Shown {
    const { view, screen, dynamicSource, surfacesAs } = this;
    return { source: this.#source.name, view, screen, dynamicSource, surfacesAs };
  }

  /** Of the texels that the source in use reads. */
  get #shownValidity(): DataArrayTexture | undefined {
    const isOfTexels = this.#source.kind === "lightmap" || this.#source.kind === "directional";
    return isOfTexels ? this.#validity : undefined;
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
    this.#wasValidityShown ||= this.#view === "validity" && this.#shownValidity !== undefined;
    const shadings = new Map<string, Shading>();
    for (const surface of this.#surfaces.values()) {
      const kind = `${surface.rectangles.length > 0} ${surface.isDynamic}`;
      const shading = shadings.get(kind) ?? this.#shadingOf(surface);
      shadings.set(kind, shading);
      this.#wardrobe.dress(surface.mesh, shading);
    }
    this.#firstBounce.shine(this.#source);
    this.#showGrid(this.#source.kind === "three-probes");
  }

  #setScreen(texture: Texture | null): void {
    this.#isScreened = texture !== null;
    if (!texture || this.#screen?.texture === texture) return;
    // One for good, so that materials which read it are made once.
    this.#screen ??= new ScreenLight(texture);
    this.#screen.texture = texture;
    this.#painter.screenChanged(this.#screen);
  }

  /** What a source that nobody sees any more holds. */
  #free(source: Source): void {
    const kept = this.#sources.flatMap(({ made }) => made);
    const textures = new Set(kept.flatMap((shader) => shader.textures));
    for (const shader of source.made.filter((made) => !kept.includes(made))) {
      this.#wardrobe.discard(shader);
      disposeTextures(shader, textures);
    }
  }

  /** Alike for all surfaces that are alike in having a place in the lightmap, and in being dynamic. */
  #shadingOf({ rectangles, isDynamic }: LitSurface): Shading {
    const hasLightmap = rectangles.length > 0;
    const screen = this.#isScreened ? this.#screen : undefined;
    const { width, height } = this.baked?.lighting.lightmap ?? { width: 1, height: 1 };
    const source = screen ? this.#source : this.#sourceOf(hasLightmap, isDynamic);
    const inline = this.#lightOf(source, hasLightmap, isDynamic);
    return {
      light: screen ?? inline,
      seeThrough: inline,
      lamps: source && !hasLightmap ? this.#firstBounce.lamps(source, this.#source) : undefined,
      direct: screen && hasLightmap && this.#source.hasDirectMap ? this.#directMap() : undefined,
      view: this.#view,
      baked: this.#surfacesAs === "baked" && this.#view === null ? "whole" : undefined,
      mask: hasLightmap ? this.#mask : undefined,
      validity: hasLightmap && this.#view === "validity" ? this.#shownValidity : undefined,
      lightmap: hasLightmap ? [width, height] : undefined,
    };
  }

  /** The file's map of direct light alone. */
  #directMap(): LightShader | undefined {
    const [map, entry] = [this.baked?.direct, this.baked?.lighting.direct];
    if (map && entry) this.#direct ??= lightmapShader(map, entry.scale, "full", this.#painter.limits);
    return this.#direct;
  }

  /** What lights a mesh. */
  #sourceOf(hasLightmap: boolean, isDynamic: boolean): Source | undefined {
    const { kind, isDynamic: isEverywhere } = this.#source;
    const isOurs = hasLightmap || kind === "three-probes" || kind === "none" || (isEverywhere && !isDynamic);
    return isOurs ? this.#source : this.#dynamic;
  }

  #lightOf(
    source: Source | undefined,
    hasLightmap: boolean,
    isDynamic: boolean,
  ): LightShader | GridLight | undefined {
    if (source?.kind === "three-probes") return this.#threeGrid();
    if (hasLightmap) return source?.shader;
    const isStatic = !isDynamic && source === this.#source;
    return isStatic ? source?.bare : source?.moving;
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
