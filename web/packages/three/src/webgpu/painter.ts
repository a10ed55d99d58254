/** Light in the materials of WebGPURenderer, by their context's getGI. */
import type { LightShader, LightView, Precision, Probes, TextureLimits } from "@irradia/runtime";
import type { Material } from "three";
import { context, Fn, renderGroup, screenUV, texture, uniform, vec3, vec4 } from "three/tsl";
import type { Node, NodeBuilder, TextureNode } from "three/webgpu";
import { GridLight, type Painter, ScreenLight, type Shading } from "../core/painter.js";
import { simplify } from "../core/see-through.js";
import type { ShadowMask } from "../core/shadow-mask.js";
import type { Inputs } from "../types.js";
import { prepare, through } from "./baked.js";
import { lightNode } from "./bind.js";
import { inputsOf } from "./inputs.js";
import { shine } from "./lamps.js";
import { ownIrradiance, probeGrid } from "./probe-grid.js";
import { shadowLight } from "./shadow.js";
import { commonView, MISSING_VIEW, validityView } from "./views.js";

type Vec3Node = Node<"vec3">;

/** What a lit material's nodes find while their shader is built. */
interface LightingContext {
  readonly ambientOcclusion: Node<"float">;
  readonly iblIrradiance: Vec3Node;
}

/** Any material becomes a node material when it is drawn, with these properties among the others. */
interface NodeSlots {
  contextNode: Node;
  outputNode: Node;
}

/** So that a material without ambient light at all still divides. */
const LEAST_OCCLUSION = 1e-3;

export class WebGPUPainter implements Painter {
  readonly #intensity = uniform(1).setGroup(renderGroup);
  readonly #screens = new WeakMap<ScreenLight, TextureNode>();

  constructor(
    readonly limits: TextureLimits,
    readonly precision: Precision = "float",
  ) {}

  get intensity(): number {
    return this.#intensity.value;
  }

  set intensity(factor: number) {
    this.#intensity.value = factor;
  }

  paint(copy: Material, original: Material, shading: Shading, key: string): void {
    const { light, baked, view } = shading;
    const slots = copy as Material & Partial<NodeSlots>;
    if (baked) {
      simplify(copy, baked);
      prepare(copy, original, baked);
    }
    if (light || baked) slots.contextNode = context({ getGI: () => this.#indirect(shading) });
    if (view) slots.outputNode = this.#view(shading);
    if (baked === "passed") slots.outputNode = vec4(through(copy), 1);
    copy.customProgramCacheKey = () => `${original.customProgramCacheKey()}|${key}`;
  }

  screenChanged(screen: ScreenLight): void {
    this.#screenNode(screen).value = screen.texture;
  }

  shadow({ channels, texture: mask }: ShadowMask): () => void {
    const undo = [...channels].map(([light, channel]) => shadowLight(light, mask, channel));
    return () => {
      for (const each of undo) each();
    };
  }

  probeGrid(probes: Probes): GridLight {
    return probeGrid(probes);
  }

  /** E as three.js is to add it to its irradiance, once that holds the rest. */
  #indirect(shading: Shading): Vec3Node {
    return Fn((builder: NodeBuilder) => {
      const { ambientOcclusion, iblIrradiance } = builder.context as LightingContext;
      if (shading.lamps) shine(shading.lamps, this.#intensity, builder);
      // All indirect light is multiplied by the occlusion, which baked light holds already. It holds the sky as
      // well: the environment's diffuse light goes by the very formula that it came in by.
      if (!shading.light) return vec3(0);
      if (shading.light instanceof GridLight) return iblIrradiance.negate();
      return this.#irradiance(shading, builder).div(ambientOcclusion.max(LEAST_OCCLUSION)).sub(iblIrradiance);
    })() as Vec3Node;
  }

  #irradiance(shading: Shading, builder: NodeBuilder): Vec3Node {
    return this.#unscaled(shading, inputsOf(builder, shading.lightmap !== undefined)).mul(this.#intensity);
  }

  #unscaled({ light, direct }: Shading, inputs: Partial<Inputs<Node>>): Vec3Node {
    if (!light) return vec3(0);
    if (light instanceof GridLight) return ownIrradiance(light);
    if (!(light instanceof ScreenLight)) return lightOf(light, inputs);
    const { rgb } = this.#screenNode(light).sample(screenUV) as Node<"vec4">;
    return direct ? rgb.add(lightOf(direct, inputs)) : rgb;
  }

  #view(shading: Shading): Node {
    return Fn((builder: NodeBuilder) => vec4(this.#viewOf(shading, builder), 1))();
  }

  #viewOf(shading: Shading, builder: NodeBuilder): Vec3Node {
    const { light, view, validity, lightmap } = shading;
    if (validity) return validityView(validity);
    if (view === "irradiance") return this.#irradiance(shading, builder).div(Math.PI) as Vec3Node;
    const common = commonView(view, builder, lightmap);
    if (common) return common;
    const hasView = light && "views" in light && light.views[view as LightView];
    if (!hasView) return MISSING_VIEW;
    return lightNode(light, inputsOf(builder, lightmap !== undefined), view as LightView);
  }

  #screenNode(screen: ScreenLight): TextureNode {
    const node = this.#screens.get(screen) ?? texture(screen.texture);
    this.#screens.set(screen, node as TextureNode);
    return node as TextureNode;
  }
}

/** Instances without a lightmap stay dark under one. */
function lightOf(light: LightShader, inputs: Partial<Inputs<Node>>): Vec3Node {
  const node = lightNode(light, inputs);
  const page = inputs.page as Node<"float"> | undefined;
  return page && light.inputs.includes("page") ? (page.lessThan(0).select(vec3(0), node) as Vec3Node) : node;
}
