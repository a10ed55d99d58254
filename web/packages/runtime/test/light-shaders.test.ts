import assert from "node:assert/strict";
import { test } from "node:test";
import {
  type BakedLight,
  directionalShader,
  fieldShader,
  type LightShader,
  lightmapShader,
  NO_PROBE,
  type ProbeOctree,
  type Probes,
  probeShader,
  readBakedGlb,
  WEBGL2_LIMITS,
  withDirect,
} from "@irradia/runtime";
import { everything, type Glb, glbBytes, N_PROBES, PAGES } from "./glb-file.js";
import { refuses } from "./hostile.js";
import { Random } from "./random.js";

const TEXELS = PAGES.width * PAGES.height * PAGES.pages;

function baked(change: (glb: Glb) => void = () => {}): BakedLight {
  const glb = everything();
  change(glb);
  return readBakedGlb(glbBytes(glb)) ?? assert.fail("no light in it");
}

function made(): { readonly plain: LightShader; readonly indirect: LightShader; readonly light: BakedLight } {
  const light = baked();
  const { lightmap, field } = light;
  assert.ok(lightmap && field);
  return {
    light,
    plain: lightmapShader(lightmap, 2, "full", WEBGL2_LIMITS),
    indirect: fieldShader(field, WEBGL2_LIMITS),
  };
}

function directOf({ direct }: BakedLight): NonNullable<BakedLight["direct"]> {
  return direct ?? assert.fail();
}

function probesOf({ probes }: BakedLight): Probes {
  return probes ?? assert.fail();
}

function functionsOf(text: string): string[] {
  return [...text.matchAll(/^(?:fn|void|float|u?int|[ui]?vec\d) (\w+)\(/gm)].map(([, name]) => name ?? "");
}

test("a lightmap's scale carries π, since its texels are E/π", () => {
  const { plain, light } = made();
  assert.deepEqual(plain.inputs, ["lightmapUv", "page"]);
  assert.equal(plain.textures[0]?.data, light.lightmap?.texels);
  assert.equal(plain.uniforms[0]?.values[0], Math.fround(2 * Math.PI));
  assert.deepEqual(plain.cost, { flops: 6, fetches: 1, bytes: 4 * TEXELS + 16 });
});

test("directional modes ask for what they read, and only light carries π", () => {
  const { light } = made();
  const shader = directionalShader(light, WEBGL2_LIMITS);
  assert.deepEqual(shader.inputs, ["normal", "surfaceNormal", "lightmapUv", "page"]);
  assert.deepEqual(
    shader.textures.map(({ name }) => name),
    ["irradia_sh_mean", "irradia_sh_direction"],
  );
  assert.deepEqual([...(shader.uniforms[0]?.values ?? [])], [2 * Math.PI, 2, 0, 0].map(Math.fround));
  refuses(() => directionalShader({ ...light, lighting: {} }, WEBGL2_LIMITS), /expected directional maps/);
});

test("rnm needs tangents", () => {
  const light = baked(({ json }) => {
    const { directional } = json.extensions.IRRADIA_lighting;
    const { sh_direction: map } = directional.maps;
    directional.mode = "rnm";
    directional.maps = { rnm_0: map, rnm_1: map, rnm_2: map };
  });
  assert.ok(directionalShader(light, WEBGL2_LIMITS).inputs.includes("tangent"));
});

test("a direct map makes indirect light whole, in both languages", () => {
  const { indirect, light } = made();
  const both = withDirect(indirect, directOf(light), 2, WEBGL2_LIMITS);
  assert.deepEqual(both.inputs, ["position", "normal", "lightmapUv", "page"]);
  assert.equal(both.quantity, "full");
  assert.equal(both.cost.fetches, indirect.cost.fetches + 1);
  for (const language of ["wgsl", "glsl"] as const) {
    const names = functionsOf(both.text(language));
    assert.equal(new Set(names).size, names.length, "a function is there twice");
    for (const name of [both.entry, ...Object.values(both.views)]) assert.ok(names.includes(name), name);
  }
});

test("a direct map isn't added to what holds its light already", () => {
  const { plain, light } = made();
  refuses(() => withDirect(plain, directOf(light), 2, WEBGL2_LIMITS), /expected a source of indirect light/);
});

test("all names of all texts are ours", () => {
  const { plain, indirect, light } = made();
  const shaders = [
    plain,
    indirect,
    directionalShader(light, WEBGL2_LIMITS),
    probeShader(probesOf(light), WEBGL2_LIMITS),
  ];
  for (const shader of shaders) {
    for (const language of ["wgsl", "glsl"] as const) {
      const names = functionsOf(shader.text(language));
      assert.ok(names.includes(shader.entry));
      for (const name of names) assert.match(name, /^irradia_[a-z_]+$/);
    }
  }
});

test("probes that don't count have no reach", () => {
  const probes = probesOf(baked());
  const shader = probeShader(probes, WEBGL2_LIMITS);
  const records = shader.textures.find(({ name }) => name === "irradia_probes");
  const floats = new Float32Array((records?.data as Uint32Array).buffer);
  for (let probe = 0; probe < N_PROBES; probe++) {
    const expected = probes.states[probe] === 0 ? (probes.reaches[probe] ?? 0) : -1;
    assert.equal(floats[20 * probe + 3], expected);
    assert.equal(floats[20 * probe], (probes.positions[3 * probe] ?? 0) + (probes.offsets[3 * probe] ?? 0));
  }
});

test("loose probes are refused with a way out", () => {
  const { structure: _, ...loose } = probesOf(baked());
  refuses(() => probeShader(loose, WEBGL2_LIMITS), /loose ones.*\n.*--probes auto/);
});

/** Leaves of a tree that is split at random, with holes. */
function randomOctree(random: Random): ProbeOctree {
  const cells: number[][] = [];
  const split = (x: number, y: number, z: number, level: number): void => {
    if (level < 4 && random.below(3) === 0) {
      for (let i = 0; i < 8; i++) split(2 * x + (i & 1), 2 * y + ((i >> 1) & 1), 2 * z + (i >> 2), level + 1);
    } else if (random.below(4) || cells.length === 0) cells.push([x, y, z, level]);
  };
  for (let root = 0; root < 12; root++) split(root % 3, Math.floor(root / 3) % 2, Math.floor(root / 6), 0);
  const count = cells.length;
  return {
    kind: "octree",
    origin: [0, 0, 0],
    size: 1,
    count,
    cells: Uint16Array.from(cells.flat()),
    corners: new Uint32Array(8 * count).fill(NO_PROBE).map((_, i) => i % N_PROBES),
  };
}

function octreeShader(structure: ProbeOctree): LightShader {
  return probeShader({ ...probesOf(baked()), structure }, WEBGL2_LIMITS);
}

/** The leaf of a place, walked to as `shaders/wgsl/probe-cell-octree.wgsl` does. */
function leafAt(shader: LightShader, place: readonly number[]): { leaf: number; isNeighbour: boolean } {
  const words = (shader.textures.find(({ name }) => name === "irradia_probe_cells") ?? assert.fail()).data;
  const shape = shader.uniforms[0]?.values.slice(8, 11) ?? assert.fail();
  const wordAt = (index: number): number => words[index] ?? assert.fail(`no word ${index}`);
  const rootAt = ([x = 0, y = 0, z = 0]: readonly number[]): number =>
    wordAt(x + (shape[0] ?? 0) * (y + (shape[1] ?? 0) * z));
  let low = place.map((at, axis) => Math.min(Math.floor(at), (shape[axis] ?? 1) - 1));
  let word = rootAt(low);
  let isNeighbour = word >>> 30 === 2;
  if (isNeighbour) {
    low = [word & 1023, (word >> 10) & 1023, (word >> 20) & 1023];
    word = rootAt(low);
  }
  let share = place.map((at, axis) => Math.min(Math.max(at - (low[axis] ?? 0), 0), 1));
  while (word >>> 30 === 0) {
    const first = word;
    low = share.map((at) => Math.min(Math.floor(2 * at), 1));
    word = wordAt(first + (low[0] ?? 0) + 2 * (low[1] ?? 0) + 4 * (low[2] ?? 0));
    if (word >>> 30 === 2) {
      isNeighbour = true;
      const child = word & 7;
      low = [child & 1, (child >> 1) & 1, child >> 2];
      word = wordAt(first + child);
    }
    share = share.map((at, axis) => Math.min(Math.max(2 * at - (low[axis] ?? 0), 0), 1));
  }
  assert.equal(word >>> 30, 1);
  return { leaf: word & 0x3fffffff, isNeighbour };
}

test("every place of an octree finds the leaf that holds it, and holes a leaf beside them", () => {
  const random = new Random(12);
  let [found, holes] = [0, 0];
  for (let round = 0; round < 20; round++) {
    const tree = randomOctree(random);
    const shader = octreeShader(tree);
    for (let i = 0; i < 50; i++) {
      const place = [random.below(3000) / 1000, random.below(2000) / 1000, random.below(2000) / 1000];
      const { leaf, isNeighbour } = leafAt(shader, place);
      const [x = 0, y = 0, z = 0, level = 0] = tree.cells.subarray(4 * leaf, 4 * leaf + 4);
      const isInside = [x, y, z].every((at, axis) => Math.floor((place[axis] ?? 0) * 2 ** level) === at);
      assert.equal(isInside, !isNeighbour);
      if (isInside) found++;
      else holes++;
    }
  }
  assert.ok(found > 300 && holes > 50, `${found} in leaves, ${holes} in holes`);
});

test("leaves that overlap or lie absurdly far apart are refused", () => {
  const leaves = (...cells: number[][]): ProbeOctree => ({
    ...randomOctree(new Random(1)),
    count: cells.length,
    cells: Uint16Array.from(cells.flat()),
    corners: new Uint32Array(8 * cells.length),
  });
  refuses(() => octreeShader(leaves([0, 0, 0, 0], [1, 0, 0, 1])), /leaf 1 overlaps another/);
  refuses(() => octreeShader(leaves([1, 0, 0, 1], [0, 0, 0, 0])), /leaf 1 overlaps another/);
  refuses(() => octreeShader(leaves([0, 0, 0, 0], [0, 0, 0, 0])), /leaf 1 overlaps another/);
  refuses(() => octreeShader(leaves([65535, 65535, 65535, 0])), /cells of level 0, found 65536 ×/);
});
