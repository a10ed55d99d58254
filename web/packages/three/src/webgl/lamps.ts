/** Lamps in the materials of WebGLRenderer: three.js' own formulas over a list of ours. */
import {
  type DirectionalLight,
  type IUniform,
  type Light,
  type PointLight,
  ShaderChunk,
  type SpotLight,
  Vector3,
} from "three";
import type { Lamp, Lamps } from "../core/lamps.js";

/** Vectors a lamp: place and whether it has one; axis and cone; colour and reach; decay and penumbra. */
const VECTORS = 4;
/** Cosines of a cone that is wider than any. */
const [NO_CONE, NO_PENUMBRA] = [-3, -2];

/** To stand behind three.js' own functions of lights. */
export function lampDeclarations({ list }: Lamps): string {
  return `
uniform vec4 irradiaLamps[${VECTORS * list.length}];
IncidentLight irradiaLamp(int first, vec3 position) {
  vec4 place = irradiaLamps[first], axis = irradiaLamps[first + 1], colour = irradiaLamps[first + 2];
  vec4 shape = irradiaLamps[first + 3];
  vec3 along = (viewMatrix * vec4(axis.xyz, 0.0)).xyz;
  IncidentLight lamp = IncidentLight(colour.rgb, along, true);
  if (place.w > 0.0) {
    vec3 towards = (viewMatrix * vec4(place.xyz, 1.0)).xyz - position;
    lamp.direction = normalize(towards);
    lamp.color *= getDistanceAttenuation(length(towards), colour.w, shape.x);
    lamp.color *= getSpotAttenuation(axis.w, shape.y, dot(lamp.direction, along));
  }
  return lamp;
}`;
}

/** Adds their light; to stand behind three.js' lights. */
export function lampLight({ list }: Lamps): string {
  return `
${compensation()}
for (int i = 0; i < ${VECTORS * list.length}; i += ${VECTORS}) {
  IncidentLight irradiaIncident = irradiaLamp(i, geometryPosition);
  RE_Direct(irradiaIncident, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight);
}`;
}

/** What some releases of three.js work out only where there are lights of its own. */
function compensation(): string {
  const isThere = ShaderChunk.lights_physical_pars_fragment.includes("multiScatteringCompensation");
  if (!isThere) return "";
  return `#ifdef STANDARD
material.multiScatteringCompensation =
  vec3(1.0) + (1.0 / dot(material.dfg.xy, vec2(1.0)) - 1.0) * material.specularColorBlended;
#endif`;
}

/** The uniform of a list, written anew each time that a frame is drawn. */
export class LampUniform {
  readonly uniform: IUniform<Float32Array>;
  readonly #lamps: Lamps;
  #frame = -1;

  constructor(lamps: Lamps) {
    this.#lamps = lamps;
    this.uniform = { value: new Float32Array(4 * VECTORS * lamps.list.length) };
  }

  update(intensity: number, frame: number): void {
    if (frame === this.#frame) return;
    this.#frame = frame;
    this.uniform.value.set(this.#lamps.list.flatMap((lamp) => vectorsOf(lamp, intensity)));
  }
}

function vectorsOf({ light, isTaken }: Lamp, intensity: number): number[] {
  const place = new Vector3().setFromMatrixPosition(light.matrixWorld);
  const colour = light.color.clone().multiplyScalar(light.intensity * (isTaken ? -1 : intensity));
  const { distance = 0, decay = 0, angle, penumbra = 0 } = light as Partial<SpotLight & PointLight>;
  const cone = angle === undefined ? NO_CONE : Math.cos(angle);
  const inner = angle === undefined ? NO_PENUMBRA : Math.cos(angle * (1 - penumbra));
  return [
    ...[...place.toArray(), "isDirectionalLight" in light ? 0 : 1],
    ...[...axisOf(light, place).toArray(), cone],
    ...[...colour.toArray(), distance],
    ...[decay, inner, 0, 0],
  ];
}

/** From its target to the light. */
function axisOf(light: Light, place: Vector3): Vector3 {
  const { target } = light as Partial<DirectionalLight>;
  return target
    ? new Vector3().setFromMatrixPosition(target.matrixWorld).sub(place).negate().normalize()
    : new Vector3();
}
