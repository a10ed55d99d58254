/** Reflection as the bake saw it, in the materials of WebGLRenderer; see irradia.transport.materials. */
import { type IUniform, type Material, Vector2 } from "three";
import { type BakedPart, MAX_REFLECTANCE } from "../core/painter.js";
import { hasReflectance, transmissionOf } from "../core/see-through.js";

export const BAKED = {
  declarations: "uniform vec2 irradiaSeeThrough; // transmission, and whether alpha blends",
  /** In place of the chunk of its name; the map of transmission is in the slot. */
  alphaMap: `
float irradiaTransmission = irradiaSeeThrough.x;
#ifdef USE_ALPHAMAP
irradiaTransmission *= texture2D(alphaMap, vAlphaMapUv).r;
#endif`,
  /** Behind \`lights_physical_fragment\`: what has one diffuse lobe of ρ, and no other. */
  material: `
float irradiaCoverage = irradiaSeeThrough.y > 0.0 ? clamp(diffuseColor.a, 0.0, 1.0) : 1.0;
irradiaTransmission *= 1.0 - material.metalness;
vec3 irradiaFresnel = (20.0 * material.specularColorBlended + material.specularF90) / 21.0;
vec3 irradiaDiffuse =
  material.diffuseContribution * (1.0 - max(irradiaFresnel.r, max(irradiaFresnel.g, irradiaFresnel.b)));
vec3 irradiaThrough = 1.0 - irradiaCoverage + irradiaDiffuse * (irradiaCoverage * irradiaTransmission);
material.diffuseContribution =
  irradiaCoverage * min(irradiaDiffuse * (1.0 - irradiaTransmission) + irradiaFresnel, ${MAX_REFLECTANCE});
material.diffuseColor = material.diffuseContribution;
material.metalness = 0.0;
material.specularColor = vec3(0.0);
material.specularColorBlended = vec3(0.0);
material.specularF90 = 0.0;`,
  through: "outgoingLight = irradiaThrough;",
};

/** Puts the map of transmission where three.js reads it, since its own slot means a pass behind the material. */
export function prepare(copy: Material, original: Material): void {
  if (!hasReflectance(copy) || !hasReflectance(original)) return;
  copy.alphaMap = original.transmissionMap ?? null;
}

export function bakedUniforms(original: Material, part: BakedPart): Record<string, IUniform> {
  const isPane = part !== "whole";
  const transmission = isPane ? transmissionOf(original) : 0;
  return { irradiaSeeThrough: { value: new Vector2(transmission, isPane && original.transparent ? 1 : 0) } };
}
