import assert from "node:assert/strict";
import { test } from "node:test";
import {
  type BakedLight,
  directionalShader,
  FieldEvaluator,
  gltfFile,
  irradianceOf,
  lightmapShader,
  planLightTexture,
  probeCoefficients,
  probeShader,
  readBakedGlb,
  readFieldOf,
  readGlb,
  readLighting,
  readMap,
  readNodeLight,
  readProbes,
  texelRgb,
  viewsOfLighting,
  viewsOfNodes,
  WEBGL2_LIMITS,
} from "@irradia/runtime";
import { everything, type Glb, glbBytes, N_PROBES, PAGES, texelAt } from "./glb-file.js";
import { corrupted, corruptedJson, refuses, survives } from "./hostile.js";
import { Random } from "./random.js";

const ROUNDS = 400;

function baked(change: (glb: Glb) => void = () => {}): BakedLight {
  const glb = everything();
  change(glb);
  return readBakedGlb(glbBytes(glb)) ?? assert.fail("no light in it");
}

function lightingOf({ json }: Glb): Glb["json"] {
  return json.extensions.IRRADIA_lighting;
}

test("maps come back texel by texel, in both encodings", () => {
  const { lightmap, direct, directional, lighting } = baked();
  assert.deepEqual([lighting.lightmap?.scale, lighting.direct?.scale], [2, 2]);
  const maps = [lightmap, direct, directional?.get("sh_l0"), directional?.get("sh_direction")];
  for (const map of maps) {
    assert.ok(map);
    assert.deepEqual([map.width, map.height, map.layers], [PAGES.width, PAGES.height, PAGES.pages]);
    for (let i = 0; i < 16; i++) {
      const [x, y, layer] = [i % 4, (i >> 2) % 2, i >> 3];
      assert.deepEqual(texelRgb(map, x, y, layer), texelAt(i));
    }
  }
  assert.deepEqual([...(directional?.keys() ?? [])], ["sh_l0", "sh_direction"]);
});

test("primitives come back with their rectangles, instances with theirs", () => {
  const { nodes } = baked();
  const whole = { page: 0, scale: [1, 1], offset: [0, 0] };
  assert.deepEqual(nodes.get(0)?.primitives, [
    { texCoord: 1, rectangles: [whole] },
    undefined,
    { texCoord: 2, rectangles: [{ page: 1, scale: [0.12, 0.12], offset: [0.5, 0.25] }] },
  ]);
  assert.deepEqual(nodes.get(1)?.primitives, [
    { texCoord: 1, rectangles: [{ page: 1, scale: [0.5, 0.5], offset: [0, 0] }, undefined] },
  ]);
  assert.deepEqual(nodes.get(2), { primitives: [], bakedLight: 0, bakedIesLight: 4, shadowMaskChannel: 3 });
  assert.equal(nodes.has(3), false);
});

test("every page has its image of validity", () => {
  assert.deepEqual(
    baked().validity?.map((png) => [...png]),
    [[0], [1]],
  );
});

test("a lightmap holds the light that it says, and all where it says nothing", () => {
  const lights = [undefined, "full", "indirect"].map((light) => {
    const found = baked((g) => {
      lightingOf(g).lightmap.light = light;
    });
    return [found.lighting.lightmap?.light, directionalShader(found, WEBGL2_LIMITS).quantity];
  });
  assert.deepEqual(lights, [
    ["full", "full"],
    ["full", "full"],
    ["indirect", "indirect"],
  ]);
});

test("the field inside gives light", () => {
  const { field } = baked();
  const light = new FieldEvaluator(field ?? assert.fail()).irradiance([0, 1, 2], [0, 1, 0]);
  assert.ok(light.every((channel) => channel > 0));
});

test("probes come back in radiance, and E of even light is π times it", () => {
  const { probes } = baked();
  assert.ok(probes);
  assert.equal(probes.count, N_PROBES);
  assert.equal(probes.structure?.kind, "octree");
  assert.equal(probeCoefficients(probes, 0)[0], 2); // half 0x3c00 is 1, and the scale is 2
  const even = Float64Array.from({ length: 27 }, (_, i) => (i < 3 ? 1 / 0.28209479177387814 : 0));
  for (const channel of irradianceOf(even, [0.6, 0, 0.8])) assert.ok(Math.abs(channel - Math.PI) < 1e-12);
});

test("a document without our light has none", () => {
  const glb = everything();
  glb.json.extensions = {};
  assert.equal(readBakedGlb(glbBytes(glb)), undefined);
});

test("behind another loader, fetching the views that it is told to, reads the same", () => {
  const glb = everything();
  const whole = baked();
  const { views } = readGlb(glbBytes(glb));
  const { json } = gltfFile(glb.json, views);
  const wanted = [...viewsOfLighting(readLighting(json) ?? assert.fail()), ...viewsOfNodes(json)];
  assert.equal(wanted.length, glb.json.bufferViews.length);
  const fetched = new Map(wanted.map((view) => [view, views(view, "test")]));
  const file = gltfFile(glb.json, (index) => fetched.get(index) ?? assert.fail(`${index} wasn't fetched`));

  const { lightmap, direct, directional, probes, field } = readLighting(file.json) ?? assert.fail();
  assert.ok(lightmap && direct && directional && probes && field);
  assert.deepEqual(readMap(lightmap, lightmap, file.views, {}), whole.lightmap);
  assert.deepEqual(readMap(direct, lightmap, file.views, {}), whole.direct);
  for (const [name, entry] of directional.maps) {
    assert.deepEqual(readMap(entry, lightmap, file.views, {}), whole.directional?.get(name));
  }
  assert.deepEqual(readProbes(probes, file.views), whole.probes);
  assert.deepEqual(readFieldOf(field, file.views, {}).tensors, whole.field?.tensors);
  for (const [node, light] of whole.nodes) assert.deepEqual(readNodeLight(file, node, lightmap), light);
});

test("lightmaps become array textures that filter", () => {
  const { lightmap, directional } = baked();
  const half = directional?.get("sh_direction");
  assert.ok(lightmap && half);
  const size = { width: 4, height: 2, layers: 2 };
  assert.deepEqual(planLightTexture(lightmap, WEBGL2_LIMITS), {
    format: "rgb9e5ufloat",
    ...size,
    nBytes: 64,
  });
  assert.deepEqual(planLightTexture(half, WEBGL2_LIMITS), { format: "rgba16float", ...size, nBytes: 128 });
  refuses(() => planLightTexture({ ...lightmap, width: 4096 }, WEBGL2_LIMITS), /at most 2048/);
});

test("a .glb cut short anywhere is refused", () => {
  const bytes = glbBytes(everything());
  for (let n = 0; n < bytes.length; n += 3) refuses(() => readBakedGlb(bytes.subarray(0, n)), /./);
});

test("what is wrong is named with its place", () => {
  const cases: [(glb: Glb) => void, RegExp][] = [
    [
      (g) => {
        lightingOf(g).version = 2;
      },
      /IRRADIA_lighting\/version: expected a whole number from 1 to 1/,
    ],
    [
      (g) => {
        lightingOf(g).lightmap.bufferView = 99;
      },
      /bufferViews\/99: expected an element/,
    ],
    [
      (g) => {
        lightingOf(g).lightmap.scale = 3;
      },
      /lightmap\/scale: expected a power of two, found 3/,
    ],
    [
      (g) => {
        lightingOf(g).lightmap.width = 5;
      },
      /expected 5 × 2 × 2 texels, found 4 × 2 × 2/,
    ],
    [
      (g) => {
        lightingOf(g).lightmap.encoding = "half";
      },
      /expected texels as half, found rgb9e5/,
    ],
    [
      (g) => {
        lightingOf(g).direct.encoding = "rgb9e5";
      },
      /direct: expected texels as rgb9e5, found half/,
    ],
    [
      (g) => {
        lightingOf(g).directional.maps.sh_l0 = 1;
      },
      /maps\/sh_l0: expected an object/,
    ],
    [
      (g) => {
        lightingOf(g).shadowMask.pages.pop();
      },
      /expected 2 pages, found 1/,
    ],
    [
      (g) => {
        lightingOf(g).validity.pages.pop();
      },
      /validity: expected 2 pages, found 1/,
    ],
    [
      (g) => {
        lightingOf(g).validity.pages[0].mimeType = "image/webp";
      },
      /validity\/pages\/0\/mimeType/,
    ],
    [
      (g) => {
        lightingOf(g).lightmap.light = "direct";
      },
      /lightmap\/light/,
    ],
    [
      (g) => {
        lightingOf(g).probes.count = 7;
      },
      /expected 378 bytes, found 324/,
    ],
    [
      (g) => {
        lightingOf(g).probes.count = 2 ** 40;
      },
      /probes\/count: expected a whole number/,
    ],
    [
      (g) => {
        lightingOf(g).field.mode = "sh1";
      },
      /isn't what the field's file says/,
    ],
    [
      (g) => {
        g.json.nodes[0].extensions.IRRADIA_lighting.primitives[0].page = 2;
      },
      /nodes\/0.*page: .* from 0 to 1/,
    ],
    [
      (g) => {
        g.json.accessors[0].count = 2 ** 31;
      },
      /accessors\/0\/count/,
    ],
    [
      (g) => {
        g.json.accessors[0].byteOffset = 8;
      },
      /accessors\/0: expected 16 bytes/,
    ],
    [
      (g) => {
        g.json.accessors[1].count = 1;
      },
      /expected 2 pages, found 1/,
    ],
    [
      (g) => {
        g.json.bufferViews[0].byteOffset = -4;
      },
      /byteOffset: expected a whole number/,
    ],
    [
      (g) => {
        g.json.bufferViews[0].byteLength = 2 ** 40;
      },
      /bufferViews\/0: expected 1099511627776 bytes/,
    ],
    [
      (g) => {
        g.json.buffers[0].uri = "data:";
      },
      /inside the .glb/,
    ],
    [
      (g) => {
        g.json.buffers[0].byteLength = 2 ** 30;
      },
      /buffers\/0\/byteLength/,
    ],
    [
      (g) => {
        g.binary.fill(0xff);
      },
      /./,
    ],
  ];
  for (const [change, pattern] of cases) refuses(() => baked(change), pattern);
});

/** All that was read, in numbers. */
function summary(bytes: Uint8Array): unknown {
  const light = readBakedGlb(bytes);
  if (!light) return null;
  const { lightmap, direct, directional, probes, field, nodes, shadowMask, validity } = light;
  const texels = [lightmap, direct, ...(directional?.values() ?? [])].map((map) => map && [...map.texels]);
  const arrays = Object.values(probes ?? {}).map((value) =>
    ArrayBuffer.isView(value) ? [...(value as Uint8Array)] : value,
  );
  const limits = { ...WEBGL2_LIMITS, maxSize: 64 };
  const costs = [
    lightmap && lightmapShader(lightmap, 1, "full", limits).cost,
    directional && directionalShader(light, limits).cost,
    probes?.structure && probeShader(probes, limits).cost,
  ];
  const e = field && new FieldEvaluator(field).irradiance([0, 1, 2], [0, 1, 0]);
  const images = [...(shadowMask ?? []), ...(validity ?? [])].map((png) => [...png]);
  return [texels, arrays, costs, e, [...nodes], images];
}

test("a .glb survives random bytes", () => {
  const random = new Random(7);
  const bytes = glbBytes(everything());
  for (let i = 0; i < ROUNDS; i++) survives(corrupted(bytes, random), summary);
});

test("a .glb survives hostile values in its JSON", () => {
  const random = new Random(8);
  const glb = everything();
  let refused = 0;
  for (let i = 0; i < ROUNDS; i++) {
    const json = corruptedJson(glb.json, random);
    refused += survives(glbBytes({ ...glb, json }), summary) ? 0 : 1;
  }
  assert.ok(refused > ROUNDS / 4, `only ${refused} of ${ROUNDS} were refused: the damage is too light`);
});
