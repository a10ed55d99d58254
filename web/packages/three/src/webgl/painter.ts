/** Light in the materials of WebGLRenderer, by onBeforeCompile. */
import type { LightShader, LightView, Probes, TextureLimits } from "@irradia/runtime";
import type { IUniform, Material, Object3D, WebGLProgramParametersWithUniforms } from "three";
import { type Painter, ScreenLight, type Shading } from "../core/painter.js";
import type { Inputs } from "../types.js";
import { bindGlsl, callOf } from "./bind.js";
import { FRAGMENT, VERTEX } from "./chunks.js";
import { probeGrid } from "./probe-grid.js";

type Pieces = Readonly<Record<string, string>>;
type Expressions = Partial<Inputs<string>>;

export class WebGLPainter implements Painter {
  readonly #intensity: IUniform<number> = { value: 1 };
  readonly #screens = new WeakMap<ScreenLight, IUniform>();

  constructor(readonly limits: TextureLimits) {}

  get intensity(): number {
    return this.#intensity.value;
  }

  set intensity(factor: number) {
    this.#intensity.value = factor;
  }

  paint(copy: Material, original: Material, shading: Shading, key: string): void {
    const [vertex, fragment] = [vertexPieces(shading), fragmentPieces(shading)];
    const uniforms = this.#uniformsOf(shading);
    copy.onBeforeCompile = (program: WebGLProgramParametersWithUniforms, renderer) => {
      original.onBeforeCompile(program, renderer);
      Object.assign(program.uniforms, uniforms);
      program.vertexShader = inserted(program.vertexShader, vertex);
      program.fragmentShader = inserted(program.fragmentShader, fragment);
    };
    copy.customProgramCacheKey = () => `${original.customProgramCacheKey()}|${key}`;
  }

  screenChanged(screen: ScreenLight): void {
    this.#uniformOf(screen).value = screen.texture;
  }

  probeGrid(probes: Probes): Object3D {
    return probeGrid(probes);
  }

  #uniformsOf({ light, direct }: Shading): Record<string, IUniform> {
    const intensity = { irradiaIntensity: this.#intensity, ...(direct && bindGlsl(direct).uniforms) };
    if (light instanceof ScreenLight) return { ...intensity, irradiaScreen: this.#uniformOf(light) };
    return { ...intensity, ...(light && bindGlsl(light).uniforms) };
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

function vertexPieces({ lightmap }: Shading): Pieces {
  const { declarations, position, place, lightmapDeclarations } = VERTEX;
  return {
    common: [declarations, lightmap && lightmapDeclarations].filter(Boolean).join("\n"),
    project_vertex: [position, lightmap && place].filter(Boolean).join("\n"),
  };
}

function fragmentPieces(shading: Shading): Pieces {
  const { light, view, lightmap } = shading;
  const inputs = { ...FRAGMENT.inputs, ...(lightmap && FRAGMENT.lightmapInputs) };
  const varyings = [FRAGMENT.declarations, lightmap && FRAGMENT.lightmapDeclarations];
  return {
    common: [...varyings, ...textsOf(shading)].filter(Boolean).join("\n"),
    lights_fragment_begin: `${FRAGMENT.frame}\nvec3 irradiaLight = irradiaIntensity * (${irradiance(shading, inputs)});`,
    ...(light && { lights_fragment_end: FRAGMENT.noSky, aomap_fragment: FRAGMENT.add }),
    ...(view && { "!opaque_fragment": `outgoingLight = ${viewOf(shading, inputs)};` }),
  };
}

function textsOf({ light, direct }: Shading): (string | undefined)[] {
  if (!(light instanceof ScreenLight)) return [light && bindGlsl(light).text];
  return [FRAGMENT.screenDeclarations, direct && bindGlsl(direct).text];
}

function irradiance({ light, direct }: Shading, inputs: Expressions): string {
  if (!light) return "vec3(0.0)";
  if (!(light instanceof ScreenLight)) return callOf(light, inputs);
  return direct ? `${FRAGMENT.screen} + ${callOf(direct, inputs)}` : FRAGMENT.screen;
}

function viewOf({ light, view, lightmap }: Shading, inputs: Expressions): string {
  if (view === "lightmap-uv") return lightmap ? FRAGMENT.checker(lightmap) : "vec3(0.0)";
  const common = FRAGMENT.views[view ?? ""];
  if (common) return common;
  const hasView = light && !(light instanceof ScreenLight) && light.views[view as LightView];
  return hasView ? callOf(light as LightShader, inputs, view as LightView) : FRAGMENT.missingView;
}
