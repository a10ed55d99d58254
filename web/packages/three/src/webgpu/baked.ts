/** Reflection as the bake saw it, in the materials of WebGPURenderer; see irradia.transport.materials. */
import type { Material, Texture } from "three";
import {
  diffuseColor,
  diffuseContribution,
  float,
  materialReference,
  max,
  metalness,
  min,
  normalView,
  specularColorBlended,
  specularF90,
  vec3,
} from "three/tsl";
import { LightingModel, type LightingModelDirectInput, type Node, type NodeBuilder } from "three/webgpu";
import { type BakedPart, MAX_REFLECTANCE } from "../core/painter.js";
import { hasReflectance, transmissionOf } from "../core/see-through.js";

type Vec3Node = Node<"vec3">;

/** What node materials read of their copy, so that programs are shared. */
interface Slots {
  irradiaTransmission: number;
  irradiaTransmissionMap: Texture | null;
  irradiaBlends: number;
  setupLightingModel(): LightingModel;
}

/** What a lit material's nodes find while their shader is built. */
interface LightingContext {
  readonly ambientOcclusion: Node<"float">;
  readonly irradiance: Vec3Node;
  readonly iblIrradiance: Vec3Node;
  readonly reflectedLight: LightingModelDirectInput["reflectedLight"];
}

/** Gives a copy one diffuse lobe of ρ, and no other. */
export function prepare(copy: Material, original: Material, part: BakedPart): void {
  const isPane = part !== "whole";
  const slots: Slots = {
    irradiaTransmission: isPane ? transmissionOf(original) : 0,
    irradiaTransmissionMap: isPane && hasReflectance(original) ? (original.transmissionMap ?? null) : null,
    irradiaBlends: isPane && original.transparent ? 1 : 0,
    setupLightingModel: () => new Lambertian(slots),
  };
  Object.assign(copy, slots);
}

/** The share that passes. */
export function through(copy: Material): Vec3Node {
  const slots = copy as Material & Slots;
  const passes = coverage(slots).mul(transmission(slots));
  return diffuse().mul(passes).add(coverage(slots).oneMinus()) as Vec3Node;
}

class Lambertian extends LightingModel {
  readonly #brdf: Vec3Node;

  constructor(slots: Slots) {
    super();
    const all = diffuse().mul(transmission(slots).oneMinus()).add(meanFresnel());
    this.#brdf = min(all, MAX_REFLECTANCE).mul(coverage(slots)).div(Math.PI) as Vec3Node;
  }

  override direct({ lightDirection, lightColor, reflectedLight }: LightingModelDirectInput): void {
    const cosine = normalView.dot(lightDirection as Vec3Node).clamp();
    add(reflectedLight.directDiffuse, this.#brdf.mul(cosine.mul(lightColor as Vec3Node)));
  }

  override indirect(builder: NodeBuilder): void {
    const { irradiance, iblIrradiance, ambientOcclusion, reflectedLight } =
      builder.context as unknown as LightingContext;
    add(reflectedLight.indirectDiffuse, this.#brdf.mul(irradiance.add(iblIrradiance)).mul(ambientOcclusion));
  }
}

function add(sum: Node, term: Node): void {
  (sum as Vec3Node).addAssign(term as Vec3Node);
}

/** Alpha where it blends. */
function coverage({ irradiaBlends }: Slots): Node<"float"> {
  return irradiaBlends ? (diffuseColor.a.clamp() as Node<"float">) : float(1);
}

function transmission({ irradiaTransmission, irradiaTransmissionMap }: Slots): Node<"float"> {
  if (irradiaTransmission === 0) return float(0);
  const factor = materialReference("irradiaTransmission", "float") as unknown as Node<"float">;
  const map = materialReference("irradiaTransmissionMap", "texture") as unknown as Node<"vec4">;
  const share = metalness.oneMinus().mul(factor);
  return (irradiaTransmissionMap ? share.mul(map.r) : share) as Node<"float">;
}

/** Schlick's term, weighed by the cosine. */
function meanFresnel(): Vec3Node {
  return vec3(specularColorBlended as unknown as Vec3Node)
    .mul(20)
    .add(specularF90)
    .div(21) as Vec3Node;
}

function diffuse(): Vec3Node {
  const fresnel = meanFresnel();
  return diffuseContribution.mul(max(fresnel.r, fresnel.g, fresnel.b).oneMinus()) as Vec3Node;
}
