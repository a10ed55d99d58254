/** Light probes as a source of light, read without light coming through walls. docs/probes.md */
import { InputError } from "../errors.js";
import type { TextureLimits } from "../gpu/texture.js";
import type { ProbeGrid, ProbeOctree, Probes } from "../scene/probes.js";
import { composeText } from "./compose.js";
import type { LightShader, ShaderTexture } from "./light-shader.js";
import { bytesOf } from "./map-texture.js";
import { octreeCells } from "./octree-cells.js";
import { listShifts, listTexture, probeRecords, sightWords, wordsPerMap } from "./probe-records.js";

/** How deep an octree is walked down in a cost: its levels are few. */
const TYPICAL_LEVELS = 3;

export interface ProbeShaderOptions {
  /**
   * What is lit. Places on `surfaces` of the scene are looked at from a little above, and probes behind them
   * count less; `things` that move between them take the weights of the place alone.
   */
  readonly lit?: "surfaces" | "things";
}

/**
 * Probes of a grid or an octree. The surface's normal decides which probes count, the shading normal what
 * their light does.
 *
 * @throws InputError where probes are loose, or too many for the device
 */
export function probeShader(
  probes: Probes,
  limits: TextureLimits,
  { lit = "surfaces" }: ProbeShaderOptions = {},
): LightShader {
  const { structure } = probes;
  if (!structure) throw loose();
  const records = listTexture("irradia_probes", "rgba32uint", probeRecords(probes), limits);
  const sight = listTexture("irradia_probe_sight", "r32uint", sightWords(probes), limits);
  const cells = structure.kind === "grid" ? gridCells(structure) : treeCells(structure, limits);
  const textures = [records, sight, ...cells.textures];
  const { size } = probes.distances;
  const choices = { "probe-cell": `probe-cell-${structure.kind}` };
  const values = [
    ...[...structure.origin, cells.firstCorner],
    ...[...cells.spacing, lit === "surfaces" ? 1 : 0],
    ...[...cells.shape, size],
    ...[...listShifts(records.plan), ...listShifts(sight.plan)],
    ...[probes.scale, wordsPerMap(probes.distances), ...cells.shifts],
  ];
  return {
    entry: "irradia_light",
    inputs: ["position", "normal", "surfaceNormal"],
    textures,
    uniforms: [{ name: "irradia_probe_layout", values: Float32Array.from(values) }],
    quantity: probes.light,
    cost: { flops: 1600, fetches: 8 * 9 + cells.fetches, bytes: bytesOf(textures, 5) },
    views: { validity: "irradia_view_validity" },
    text: (language) => composeText(language, [{ piece: "probes-light", choices }]),
  };
}

/** What the two structures differ in. */
interface Cells {
  readonly spacing: readonly number[];
  readonly shape: readonly number[];
  readonly firstCorner: number;
  readonly shifts: readonly number[];
  readonly textures: readonly ShaderTexture[];
  readonly fetches: number;
}

function gridCells({ spacing, shape }: ProbeGrid): Cells {
  return { spacing, shape, firstCorner: 0, shifts: [0, 0], textures: [], fetches: 0 };
}

function treeCells(tree: ProbeOctree, limits: TextureLimits): Cells {
  const { words, shape, firstCorner } = octreeCells(tree);
  const texture = listTexture("irradia_probe_cells", "r32uint", words, limits);
  return {
    spacing: [tree.size, tree.size, tree.size],
    shape,
    firstCorner,
    shifts: listShifts(texture.plan),
    textures: [texture],
    fetches: 8 + TYPICAL_LEVELS,
  };
}

function loose(): InputError {
  return new InputError(
    "expected probes in a grid or an octree, found loose ones, which a shader can't search",
    "probes",
    "Bake with --probes auto or --probes grid:0.5.",
  );
}
