/** Surfaces that let light through, as the bake saw them: what passes is tinted, and their own light is added. */
import {
  AddEquation,
  type BufferGeometry,
  CustomBlending,
  type Material,
  type Mesh,
  type MeshPhysicalMaterial,
  OneFactor,
  SrcColorFactor,
  ZeroFactor,
} from "three";
import type { BakedPart } from "./painter.js";

const GROUPS_OF_PANES = 2;

/** Whether ρ of the bake can be worked out for a material. */
export function hasReflectance(material: Material): material is MeshPhysicalMaterial {
  return (material as MeshPhysicalMaterial).isMeshStandardMaterial === true;
}

/** Whether light passes: by alpha, or by KHR_materials_transmission. */
export function isSeeThrough(material: Material): boolean {
  return hasReflectance(material) && (material.transparent || transmissionOf(material) > 0);
}

export function transmissionOf(material: Material): number {
  return (material as MeshPhysicalMaterial).transmission ?? 0;
}

/**
 * Lets a mesh be drawn twice, by a list of two materials; with a single material nothing changes.
 *
 * @returns whether it can be: not where the geometry has groups of its own
 */
export function drawTwice({ geometry }: Mesh): boolean {
  const { groups } = geometry;
  if (groups.length === 0)
    for (let i = 0; i < GROUPS_OF_PANES; i++) geometry.addGroup(0, countOf(geometry), i);
  const isOurs = groups.every(({ start, count, materialIndex }, i) => {
    return start === 0 && count === countOf(geometry) && materialIndex === i;
  });
  return isOurs && groups.length === GROUPS_OF_PANES;
}

/** Takes from a copy what the bake's diffuse reflection has no part for, and blends it as its part asks. */
export function simplify(copy: Material, part: BakedPart): void {
  const lobes = [
    "clearcoat",
    "sheen",
    "iridescence",
    "anisotropy",
    "transmission",
    "diffuseRoughness",
  ] as const;
  for (const lobe of [...lobes, "retroreflectivity"]) if (lobe in copy) Object.assign(copy, { [lobe]: 0 });
  if (part === "whole") return;
  Object.assign(copy, {
    transparent: true,
    depthWrite: false,
    premultipliedAlpha: false,
    fog: false,
    blending: CustomBlending,
    blendEquation: AddEquation,
    blendSrc: part === "added" ? OneFactor : ZeroFactor,
    blendDst: part === "added" ? OneFactor : SrcColorFactor,
    blendSrcAlpha: ZeroFactor,
    blendDstAlpha: OneFactor,
  });
  if (part === "passed") copy.toneMapped = false;
}

function countOf({ index, attributes }: BufferGeometry): number {
  return index?.count ?? attributes.position?.count ?? 0;
}
