/** What `@irradia/three` and `@irradia/three/webgpu` have in common: the light of a scene, whatever draws it. */
import type {
  BakedLight,
  LightInput,
  LightShader,
  LightView,
  Quantity,
  Rectangle,
  TextureLimits,
} from "@irradia/runtime";
import type { Group, Light, Material, Mesh, Object3D, Texture } from "three";
import type { GLTFLoaderPlugin, GLTFParser } from "three/addons/loaders/GLTFLoader.js";

/**
 * What a source of light is made of. `three-probes` is three.js' own LightProbeGrid, filled from our probes: a
 * baseline. `none` is no baked light at all.
 */
export type SourceKind = "lightmap" | "directional" | "field" | "probes" | "three-probes" | "none";

/** One way to light the scene. */
export interface LightSource {
  /** Unique; those of the file are named after their kind. */
  readonly name: string;
  readonly kind: SourceKind;
  /** Whether first bounces of live lights are left out of its light. */
  readonly quantity: Quantity;
  /**
   * Its text, textures and cost, made when first asked for. Undefined for `none` and `three-probes`, which have
   * none of ours.
   */
  readonly shader: LightShader | undefined;
  /** The same without the file's map of direct light. */
  readonly bare: LightShader | undefined;
  /** Whether, bare, it needs position and normals alone, so that it also lights what moves or has no lightmap. */
  readonly isDynamic: boolean;
}

/**
 * What surfaces show in place of their shading. Values are linear and come before the renderer's tone mapping:
 * switch that off for all but `irradiance`.
 *
 * | view | shows |
 * |---|---|
 * | `irradiance` | E/π: the scene's light on white paint, live lights and environment left out |
 * | `albedo` | the diffuse colour |
 * | `normal` | the shading normal in world space, n/2 + 1/2 |
 * | `depth` | distance along the view, 0 at the near plane and 1 at the far one, linear |
 * | `lightmap-uv` | a checker of 4 × 4 texels a field, tinted by the page's uv; black without a lightmap |
 * | `validity` | of the lightmap's texels: grey-green where they see their surroundings, redder the more of them lies inside something, blue outside charts; of the probes around a place, from 0 to 1 |
 * | others | functions of the source in use, as `LightShader.views` lists them; magenta where it lacks one |
 */
export type View = LightView | "irradiance" | "albedo" | "normal" | "depth" | "lightmap-uv";

/**
 * Where the first bounce of lights comes from while a source is in use: the source itself holds it, a baked map
 * of direct light is added to it, the scene's live lights give it, or nobody does.
 */
export type DirectFrom = "source" | "map" | "lights" | "none";

/**
 * How surfaces answer to light. `materials`: as three.js has it, diffuse and specular apart. `baked`: as the bake
 * saw them, with emission + ρ/π · E, where ρ is all that a material reflects of even light, its reflections too;
 * see-through surfaces tint what is behind them, and bend nothing. That is how reference pictures look.
 */
export type SurfacesAs = "materials" | "baked";

/** What can be changed at once: see the properties of SceneLight of these names. */
export interface Shown {
  readonly source: string;
  readonly view: View | null;
  readonly screen: Texture | null;
  readonly dynamicSource: string | null;
  readonly surfacesAs: SurfacesAs;
}

/** A mesh that the light shines on. */
export interface LitSurface {
  readonly mesh: Mesh;
  /** Lit by `dynamicSource`: what moves, and what has no lightmap. */
  readonly isDynamic: boolean;
  /** Its place in the lightmap; several with instances; empty without. See `LIGHTMAP_ATTRIBUTES`. */
  readonly rectangles: readonly (Rectangle | undefined)[];
}

/**
 * Vertex attributes that every geometry with a lightmap carries, for passes with materials of their own:
 * page uv = `uv` · rectangle.xy + rectangle.zw, origin top left. The last two step by instance and stand in
 * geometries of plain meshes as well, with one element. A page of −1 is no lightmap.
 */
export const LIGHTMAP_ATTRIBUTES = {
  uv: "irradia_uv",
  rectangle: "irradia_rectangle",
  page: "irradia_page",
} as const;

/** What to know before a file is there. */
export interface IrradiaOptions {
  /** What the device takes; `limitsOf(renderer)` knows. By default what most devices of these years do. */
  readonly limits?: TextureLimits | undefined;
  /** The source to begin with; by default the first of directional, lightmap, field, probes that the file holds. */
  readonly source?: string | undefined;
  /** Most bytes that packed light may unpack to; 1 GiB by default. */
  readonly maxBytes?: number | undefined;
}

/** `loader.register(irradia())`. */
export type IrradiaPlugin = (parser: GLTFParser) => GLTFLoaderPlugin;

/**
 * The baked light of a loaded scene, at `gltf.userData.irradia`; there for every file, since a field may be
 * added to one that came without light. All setters take effect with the next frame.
 */
export interface SceneLight {
  /** What the file holds, as read. */
  readonly baked: BakedLight | undefined;
  /** The file's sources in the order of `SourceKind`, then those added; `none` is always there, and last. */
  readonly sources: readonly LightSource[];
  /** What lights static meshes now. */
  readonly source: LightSource;
  /**
   * Switches static meshes to another source. Each mesh gets a copy of its material for each source and view that
   * it was shown with, so going back and forth compiles nothing. Throws InputError for a name that there isn't.
   */
  use(name: string): void;
  /** Several changes at once; what is left out stays. Costs nothing where nothing changes. */
  show(changes: Partial<Shown>): void;
  /** Adds a source, or replaces the one of this name, whose textures are freed; `kind` is "field" by default. */
  add(name: string, shader: LightShader, kind?: SourceKind): LightSource;
  /** Takes an added source off; static meshes go back to the first source if it was theirs. */
  remove(name: string): void;

  /**
   * Lights an object, its children too, by the dynamic source, wherever it moves. Of the file's lights that this
   * source leaves out and that don't shine, direct light is added without shadows.
   */
  lit(object: Object3D): void;
  /** Takes an object's light away again. */
  unlit(object: Object3D): void;
  /**
   * The source of what moves or has no lightmap; null is none. By default the first of field (volume or SH),
   * probes. Set to a source that isn't dynamic, it throws InputError.
   */
  dynamicSource: string | null;

  /** Debug shading; null is the picture itself. */
  view: View | null;
  /** Views that the source in use can show. */
  readonly views: readonly View[];
  /** `materials` by default; views show the same with either. Throws InputError for anything else. */
  surfacesAs: SurfacesAs;
  /** Factor on the baked light; 1 by default. */
  intensity: number;
  /** Stops: the light times 2^exposure shows well on a display; 0 where the file doesn't say. */
  readonly exposure: number;
  readonly directFrom: DirectFrom;

  /**
   * E by pixel, in W·m⁻², in place of sources: set by full-screen passes, which evaluate sources themselves.
   * Has the size of what is drawn, texel under pixel, as one of the renderer's own targets. Where the source in use
   * takes its direct light from a map, materials add that themselves: passes evaluate `source.bare`.
   */
  screen: Texture | null;
  /** All meshes that the light shines on now. */
  readonly surfaces: readonly LitSurface[];
  /**
   * The file's punctual lights. Those whose light is baked shine only where the source leaves their first bounce
   * out and no map has it. `visible` is switched with the source. Surfaces with a lightmap show the baked shadows of
   * lights in mode `mixed`; other shadows are the page's affair.
   */
  readonly lights: readonly Light[];
  /** Call after changing a material of the scene, so that its copies for other sources and views follow. */
  refresh(): void;
  /** Counts calls of `refresh`, for passes with copies of their own. */
  readonly version: number;
  /** The material that came with the file, whose copy a mesh shows. */
  originalOf(material: Material): Material;

  /** Of textures and uniforms made so far, on the GPU. */
  readonly bytes: number;
  /** The scene that was loaded. */
  readonly scene: Group;
  /** Frees textures and puts materials back as they were. */
  dispose(): void;
}

/** A value, or an expression in a shader's language or node graph, for each input of a LightShader. */
export type Inputs<T> = Readonly<Record<LightInput, T>>;
