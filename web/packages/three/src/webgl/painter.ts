/** Light in the materials of WebGLRenderer, by onBeforeCompile. */
import type { LightShader, LightView, Probes, TextureLimits } from "@irradia/runtime";
import type { IUniform, Material, WebGLProgramParametersWithUniforms } from "three";
import type { Lamps } from "../core/lamps.js";
import { GridLight, type Painter, ScreenLight, type Shading } from "../core/painter.js";
import { simplify } from "../core/see-through.js";
import type { ShadowMask } from "../core/shadow-mask.js";
import type { Inputs } from "../types.js";
import { BAKED, bakedUniforms, prepare } from "./baked.js";
import { bindGlsl, callOf } from "./bind.js";
import { FRAGMENT, VERTEX } from "./chunks.js";
import { LampUniform, lampDeclarations, lampLight } from "./lamps.js";
import { probeGrid } from "./probe-grid.js";
import { MASK_DECLARATIONS, MaskChannels, maskedLights } from "./shadow.js";

type Pieces = Readonly<Record<string, string>>;
type Expressions = Partial<Inputs<string>>;

export class WebGLPainter implements Painter {
  readonly #intensity: IUniform<number> = { value: 1 };
  #channels: MaskChannels | undefined;
  readonly #screens = new WeakMap<ScreenLight, IUniform>();
  readonly #lamps = new WeakMap<Lamps, LampUniform>();

  constructor(readonly limits: TextureLimits) {}

  get intensity(): number {
    return this.#intensity.value;
  }

  set intensity(factor: number) {
    this.#intensity.value = factor;
  }

  paint(copy: Material, original: Material, shading: Shading, key: string): void {
    const [vertex, fragment] = [vertexPieces(shading), fragmentPieces(shading)];
    const { baked } = shading;
    const uniforms = { ...this.#uniformsOf(shading), ...(baked && bakedUniforms(original, baked)) };
    if (baked) {
      simplify(copy, baked);
      prepare(copy, original);
    }
    copy.onBeforeCompile = (program: WebGLProgramParametersWithUniforms, renderer) => {
      original.onBeforeCompile(program, renderer);
      Object.assign(program.uniforms, uniforms);
      program.vertexShader = inserted(program.vertexShader, vertex);
      const text = inserted(program.fragmentShader, fragment);
      program.fragmentShader = asBaked(masked(text, shading), shading);
    };
    if (shading.mask || shading.lamps) this.#followLights(copy, original, shading);
    copy.customProgramCacheKey = () => `${original.customProgramCacheKey()}|${key}`;
  }

  screenChanged(screen: ScreenLight): void {
    this.#uniformOf(screen).value = screen.texture;
  }

  shadow(mask: ShadowMask): () => void {
    this.#channels = new MaskChannels(mask);
    return () => {}; // materials alone know
  }

  probeGrid(probes: Probes): GridLight {
    return probeGrid(probes);
  }

  /** Which light is which changes with what shines; lamps are lights that move. */
  #followLights(copy: Material, original: Material, { mask, lamps }: Shading): void {
    copy.onBeforeRender = (renderer, scene, camera, ...rest) => {
      original.onBeforeRender(renderer, scene, camera, ...rest);
      const { frame } = renderer.info.render;
      if (mask) this.#channels?.update(scene, camera, frame);
      if (lamps) this.#lampsOf(lamps).update(this.intensity, frame);
    };
  }

  #uniformsOf({ light, direct, lamps, mask, validity }: Shading): Record<string, IUniform> {
    const intensity = {
      irradiaIntensity: this.#intensity,
      ...(direct && bindGlsl(direct).uniforms),
      ...(lamps && { irradiaLamps: this.#lampsOf(lamps).uniform }),
      ...(mask && this.#channels?.uniforms),
      ...(validity && { irradiaValidity: { value: validity } }),
    };
    if (light instanceof ScreenLight) return { ...intensity, irradiaScreen: this.#uniformOf(light) };
    return { ...intensity, ...(isShader(light) && bindGlsl(light).uniforms) };
  }

  #lampsOf(lamps: Lamps): LampUniform {
    const found = this.#lamps.get(lamps) ?? new LampUniform(lamps);
    this.#lamps.set(lamps, found);
    return found;
  }

  #uniformOf(screen: ScreenLight): IUniform {
    const uniform = this.#screens.get(screen) ?? { value: screen.texture };
    this.#screens.set(screen, uniform);
    return uniform;
  }
}

/** A shader's text with pieces behind the chunks that they are named after; a chunk starting with ! goes behind its piece. */
function inserted(text: string, pieces: Pieces): string {
  return Object.entries(pieces).reduce((result, [name, piece]) => {
    const isBefore = name.startsWith("!");
    const chunk = `#include <${isBefore ? name.slice(1) : name}>`;
    return result.replace(chunk, () => (isBefore ? `${piece}\n${chunk}` : `${chunk}\n${piece}`));
  }, text);
}

/** The shader with its live lights in their baked shadows. */
function masked(text: string, { mask }: Shading): string {
  return mask ? text.replace("#include <lights_fragment_begin>", maskedLights) : text;
}

function asBaked(text: string, { baked }: Shading): string {
  return baked ? text.replace("#include <alphamap_fragment>", BAKED.alphaMap) : text;
}

function vertexPieces({ lightmap }: Shading): Pieces {
  const { declarations, position, place, lightmapDeclarations } = VERTEX;
  return {
    common: [declarations, lightmap && lightmapDeclarations].filter(Boolean).join("\n"),
    project_vertex: [position, lightmap && place].filter(Boolean).join("\n"),
  };
}

function fragmentPieces(shading: Shading): Pieces {
  const { light, lamps, view, baked, mask, validity, lightmap } = shading;
  const inputs = { ...FRAGMENT.inputs, ...(lightmap && FRAGMENT.lightmapInputs) };
  const varyings = [FRAGMENT.declarations, lightmap && FRAGMENT.lightmapDeclarations];
  const declarations = [
    baked && BAKED.declarations,
    mask && MASK_DECLARATIONS,
    validity && FRAGMENT.validityDeclarations,
  ];
  return {
    common: [...varyings, ...textsOf(shading), ...declarations].filter(Boolean).join("\n"),
    ...(baked && { lights_physical_fragment: BAKED.material }),
    ...(lamps && { lights_pars_begin: lampDeclarations(lamps) }),
    lights_fragment_begin: [
      FRAGMENT.frame,
      `vec3 irradiaLight = ${irradiance(shading, inputs)};`,
      lamps ? lampLight(lamps) : "",
    ].join("\n"),
    ...(light && { lights_fragment_end: FRAGMENT.noSky }),
    ...(light && !(light instanceof GridLight) && { aomap_fragment: FRAGMENT.add }),
    ...(baked === "passed" && { "!opaque_fragment": BAKED.through }),
    ...(view && { "!opaque_fragment": `outgoingLight = ${viewOf(shading, inputs)};` }),
  };
}

function textsOf({ light, direct }: Shading): (string | undefined)[] {
  if (light instanceof ScreenLight) return [FRAGMENT.screenDeclarations, direct && bindGlsl(direct).text];
  return [isShader(light) ? bindGlsl(light).text : undefined];
}

function irradiance({ light, direct }: Shading, inputs: Expressions): string {
  if (light instanceof GridLight) return FRAGMENT.own;
  const terms = [
    light instanceof ScreenLight && FRAGMENT.screen,
    isShader(light) && lightOf(light, inputs),
    direct && lightOf(direct, inputs),
  ];
  return `irradiaIntensity * (${terms.filter(Boolean).join(" + ") || "vec3(0.0)"})`;
}

/** Instances without a lightmap stay dark under one. */
function lightOf(light: LightShader, inputs: Expressions): string {
  const call = callOf(light, inputs);
  return light.inputs.includes("page") ? `(${inputs.page} < 0.0 ? vec3(0.0) : ${call})` : call;
}

function isShader(light: Shading["light"]): light is LightShader {
  return light !== undefined && "entry" in light;
}

function viewOf({ light, view, validity, lightmap }: Shading, inputs: Expressions): string {
  if (validity) return FRAGMENT.validity;
  if (view === "lightmap-uv") return lightmap ? FRAGMENT.checker(lightmap) : "vec3(0.0)";
  const common = FRAGMENT.views[view ?? ""];
  if (common) return common;
  const hasView = isShader(light) && light.views[view as LightView];
  return hasView ? callOf(light, inputs, view as LightView) : FRAGMENT.missingView;
}
