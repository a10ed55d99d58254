/** Probes as spheres that show what they know. */
import { type Probes, probeCoefficients } from "@irradia/runtime";
import {
  dot,
  float,
  instanceIndex,
  int,
  ivec2,
  max,
  mix,
  normalize,
  normalLocal,
  positionLocal,
  smoothstep,
  texture,
  uniform,
  varying,
  vec3,
} from "three/tsl";
import {
  DataTexture,
  FloatType,
  IcosahedronGeometry,
  InstancedBufferGeometry,
  Mesh,
  MeshBasicNodeMaterial,
  type Node,
  RGBAFormat,
} from "three/webgpu";
import type { ProbeView } from "../state/state.js";

/** Texels of a probe: its place and state, then nine coefficients. */
const TEXELS = 10;
const PROBES_A_ROW = 64;
/** Of the distance to the next probe. */
const RADIUS = 0.12;
/** Of loose probes, whose distances nobody knows: of the scene's size. */
const LOOSE_RADIUS = 0.008;
const MOST_FACES = 4;
/** Valid, filled from neighbours, empty: coded as light of that colour. */
const STATES = [
  [0.18, 0.62, 0.3],
  [0.85, 0.5, 0.08],
  [0.7, 0.08, 0.06],
] as const;
const LUMINANCE = [0.2126, 0.7152, 0.0722] as const;

type Vec3 = Node<"vec3">;

export class ProbeSpheres {
  readonly mesh: Mesh;
  readonly #table: DataTexture;
  readonly #inverseExposure = uniform(1);
  readonly #materials = new Map<ProbeView, MeshBasicNodeMaterial>();

  /** @param size of the scene, metres */
  constructor(probes: Probes, size: number) {
    this.#table = tableOf(probes);
    this.mesh = new Mesh(spheres(probes.count), undefined);
    this.mesh.frustumCulled = false;
    this.mesh.userData.radius = radiusOf(probes, size);
  }

  show(view: ProbeView): void {
    this.mesh.visible = view !== "off";
    if (view === "off") return;
    const material = this.#materials.get(view) ?? this.#material(view);
    this.#materials.set(view, material);
    this.mesh.material = material;
  }

  /** So that colours which aren't light look the same at every exposure. */
  set ev(ev: number) {
    this.#inverseExposure.value = 2 ** -ev;
  }

  dispose(): void {
    this.mesh.geometry.dispose();
    this.#table.dispose();
    for (const material of this.#materials.values()) material.dispose();
  }

  #material(view: Exclude<ProbeView, "off">): MeshBasicNodeMaterial {
    const material = new MeshBasicNodeMaterial();
    const place = this.#texel(0);
    material.positionNode = positionLocal.mul(this.mesh.userData.radius as number).add(place.xyz);
    material.colorNode = varying(this.#colour(view));
    return material;
  }

  #colour(view: Exclude<ProbeView, "off">): Vec3 {
    const coefficients = Array.from({ length: 9 }, (_, i) => this.#texel(1 + i).xyz);
    const mean = (coefficients[0] as Vec3).mul(0.282095);
    if (view === "dc") return max(mean, 0);
    if (view === "irradiance") return max(irradiance(coefficients, normalLocal).div(Math.PI), 0);
    if (view === "direction") return spot(coefficients, mean);
    return this.#state();
  }

  #state(): Vec3 {
    const { w } = this.#texel(0);
    const [valid, filled, empty] = STATES;
    const some = mix(vec3(...valid), vec3(...filled), w.clamp(0, 1));
    const colour = mix(some, vec3(...empty), w.sub(1).clamp(0, 1));
    const relief = normalLocal.y.mul(0.25).add(0.75);
    return colour.mul(relief).mul(this.#inverseExposure);
  }

  #texel(index: number): Node<"vec4"> {
    const i = int(instanceIndex);
    const x = i.mod(PROBES_A_ROW).mul(TEXELS).add(index);
    return texture(this.#table).load(ivec2(x, i.div(PROBES_A_ROW)));
  }
}

/** E for a normal, in the order and with the constants of docs/conventions.md. */
function irradiance(c: readonly Vec3[], n: Vec3): Vec3 {
  const at = (index: number): Vec3 => c[index] ?? vec3(0);
  const [x, y, z] = [n.x, n.y, n.z];
  const band1 = at(1).mul(y).add(at(2).mul(z)).add(at(3).mul(x)).mul(0.488603);
  const band2 = at(4)
    .mul(x.mul(y).mul(1.092548))
    .add(at(5).mul(y.mul(z).mul(1.092548)))
    .add(at(6).mul(z.mul(z).mul(3).sub(1).mul(0.315392)))
    .add(at(7).mul(x.mul(z).mul(1.092548)))
    .add(at(8).mul(x.mul(x).sub(y.mul(y)).mul(0.546274)));
  const bands = [
    at(0).mul(0.282095 * Math.PI),
    band1.mul((2 * Math.PI) / 3),
    band2.mul(Math.PI / 4),
  ] as const;
  return bands[0].add(bands[1]).add(bands[2]);
}

/** A spot towards where most light comes from, in the colour of all of it. */
function spot(c: readonly Vec3[], mean: Vec3): Vec3 {
  const weight = vec3(...LUMINANCE);
  const along = (index: number): Node<"float"> => dot(c[index] ?? vec3(0), weight);
  const direction = normalize(vec3(along(3), along(1), along(2)).add(vec3(0, 1e-9, 0)));
  const isSpot = smoothstep(float(0.8), float(0.88), dot(normalLocal, direction));
  return max(mean, 0).mul(mix(float(0.25), float(2), isSpot));
}

function tableOf(probes: Probes): DataTexture {
  const rows = Math.ceil(probes.count / PROBES_A_ROW);
  const texels = new Float32Array(4 * TEXELS * PROBES_A_ROW * rows);
  for (let i = 0; i < probes.count; i += 1) {
    const at = 4 * TEXELS * i;
    for (let axis = 0; axis < 3; axis += 1) {
      texels[at + axis] = (probes.positions[3 * i + axis] ?? 0) + (probes.offsets[3 * i + axis] ?? 0);
    }
    texels[at + 3] = probes.states[i] ?? 0;
    const coefficients = probeCoefficients(probes, i);
    for (let k = 0; k < 27; k += 1) texels[at + 4 + 4 * Math.floor(k / 3) + (k % 3)] = coefficients[k] ?? 0;
  }
  const table = new DataTexture(texels, TEXELS * PROBES_A_ROW, rows, RGBAFormat, FloatType);
  table.needsUpdate = true;
  return table;
}

function spheres(count: number): InstancedBufferGeometry {
  const sphere = new IcosahedronGeometry(1, count > 1000 ? 2 : MOST_FACES);
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", sphere.getAttribute("position"));
  geometry.setAttribute("normal", sphere.getAttribute("position")); // round, though the faces are flat
  geometry.instanceCount = count;
  return geometry;
}

/** Metres. */
function radiusOf({ structure }: Probes, size: number): number {
  if (structure?.kind === "grid") return RADIUS * Math.min(...structure.spacing);
  if (structure?.kind !== "octree") return LOOSE_RADIUS * size;
  const deepest = structure.cells.reduce(
    (level, value, i) => (i % 4 === 3 ? Math.max(level, value) : level),
    0,
  );
  return RADIUS * (structure.size / 2 ** deepest);
}
