/**
 * Prints what the runtime reads in a .glb, for comparison with what Python wrote.
 *
 *   node build/print-baked.js SCENE.glb [QUESTIONS.json]
 *
 * QUESTIONS.json has positions and normals to ask the field for. Light comes in its own units, pages by row.
 */
import { readFileSync } from "node:fs";
import {
  FieldEvaluator,
  type LightTexture,
  probeCoefficients,
  readBakedGlb,
  texelRgb,
  type Vec3,
} from "@irradia/runtime";
import { decoder } from "./vectors.js";

const [scene, questions] = process.argv.slice(2);
if (!scene) throw new Error("usage: print-baked.js SCENE.glb [QUESTIONS.json]");
const baked = readBakedGlb(new Uint8Array(readFileSync(scene)), { unzstd: await decoder() });
if (!baked) throw new Error(`${scene} has no light`);
const { lighting, lightmap, directional, probes, field, nodes, shadowMask, validity } = baked;

const pages = (map: LightTexture, scale: number): number[] => {
  const { width, height, layers } = map;
  return Array.from({ length: layers * height * width }, (_, i) => {
    const [x, y, layer] = [i % width, Math.floor(i / width) % height, Math.floor(i / (width * height))];
    return texelRgb(map, x, y, layer).map((channel) => channel * scale);
  }).flat();
};

const { positions = [], normals = [] }: { positions?: Vec3[]; normals?: Vec3[] } = questions
  ? JSON.parse(readFileSync(questions, "utf8"))
  : {};
const light = field && new FieldEvaluator(field);
process.stdout.write(
  JSON.stringify({
    light: lighting.lightmap?.light,
    lightmap: lightmap && pages(lightmap, lighting.lightmap?.scale ?? Number.NaN),
    directional: Object.fromEntries(
      [...(directional ?? [])].map(([name, map]) => {
        return [name, pages(map, lighting.directional?.maps.get(name)?.scale ?? Number.NaN)];
      }),
    ),
    shadowMask: shadowMask?.map((png) => [...png]),
    validity: validity?.map((png) => [...png]),
    nodes: Object.fromEntries(nodes),
    probes: probes && {
      coefficients: Array.from({ length: probes.count }, (_, i) => [...probeCoefficients(probes, i)]),
      positions: [...probes.positions],
      states: [...probes.states],
      structure: probes.structure?.kind,
      distances: [...probes.distances.texels],
    },
    irradiance: light && positions.map((position, i) => light.irradiance(position, normals[i] ?? [0, 1, 0])),
  }),
);
