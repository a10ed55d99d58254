import assert from "node:assert/strict";
import { test } from "node:test";
import {
  type Encoding,
  entryPlace,
  type Field,
  type FieldFrame,
  type FieldSpec,
  HashGrid,
  type HashGridOptions,
  Identity,
  packField,
  planFieldTextures,
  type TableTexture,
  type Tensor,
  type TextureLimits,
  TriPlane,
  tensorShapes,
  tensorValues,
  texelStride,
  WEBGL2_LIMITS,
  WEBGPU_LIMITS,
  wordsPerTexel,
} from "@irradia/runtime";
import { refuses } from "./hostile.js";
import { Random } from "./random.js";
import { decoder, readAny, vector, vectors } from "./vectors.js";

const unzstd = await decoder();
const TINY: TextureLimits = { maxSize: 9, maxLayers: 256, maxUniformBytes: 65536 };
const NO_UNIFORMS: TextureLimits = { ...WEBGL2_LIMITS, maxUniformBytes: 64 };

function fieldOf(name: string): Field {
  const { file, bytes } = vector(name);
  return readAny(file, bytes, { unzstd });
}

/** A half float as `unpackHalf2x16` sees it. */
function half(bits: number): number {
  const [sign, exponent, mantissa] = [bits >> 15 ? -1 : 1, (bits >> 10) & 31, bits & 1023];
  return sign * (exponent ? (1 + mantissa / 1024) * 2 ** (exponent - 15) : mantissa * 2 ** -24);
}

/** What a shader does: feature f of an entry, from the texture's words and the constants. */
function fetched(table: TableTexture, words: Uint32Array, constants: Float32Array, scalesVec4: number) {
  const { bits, nFeatures } = table.entry;
  return (placed: TableTexture["tensors"][number], entry: number, f: number): number => {
    const { word, bit } = entryPlace(table, placed.firstTexel, entry);
    const at = bit + f * bits;
    const nWords = wordsPerTexel(table.texture);
    const place = word + Math.floor(at / 32 / nWords) * texelStride(table) + (Math.floor(at / 32) % nWords);
    const raw = words[place] ?? Number.NaN;
    if (bits === 32) return new Float32Array(Uint32Array.of(raw).buffer)[0] ?? Number.NaN;
    const value = (raw >>> (at % 32)) & (2 ** bits - 1);
    if (bits === 16) return half(value);
    const code = bits === 8 ? (value << 24) >> 24 : value - 8;
    const block = Math.floor((entry * nFeatures + f) / placed.block);
    return Math.fround(code * (constants[4 * scalesVec4 + placed.firstScale + block] ?? Number.NaN));
  };
}

/** Every value of every table as a shader finds it, against the tensors themselves. */
function expectTables(field: Field, limits: TextureLimits): void {
  const plan = planFieldTextures(field, limits);
  const packed = packField(field, plan);
  const seen: string[] = [];
  plan.tables.forEach((table, i) => {
    const words = packed.tables[i] ?? new Uint32Array();
    assert.equal(words.byteLength, table.texture.nBytes);
    assert.ok(Math.max(table.texture.width, table.texture.height) <= limits.maxSize);
    const fetch = fetched(table, words, packed.constants, plan.constants.scalesVec4);
    const { nFeatures } = table.entry;
    for (const placed of table.tensors) {
      seen.push(placed.tensor);
      tensorValues(field.tensors.get(placed.tensor) ?? assert.fail()).forEach((value, v) => {
        const found = fetch(placed, Math.floor(v / nFeatures), v % nFeatures);
        assert.equal(found, value, `${placed.tensor} ${v}`);
      });
    }
  });
  const tables = [...field.tensors.keys()].filter((tensor) => !tensor.startsWith("mlp."));
  assert.deepEqual(seen.sort(), tables.sort());
}

/** A field of numbers without meaning; `stored` says how the tensor at a place is. */
function madeUp(position: Encoding, stored: (index: number) => "half" | "float" | 4 | 8): Field {
  const random = new Random(3);
  const spec: FieldSpec = {
    position,
    direction: new Identity(),
    width: 5,
    nHiddenLayers: 1,
    activation: "relu",
    head: "exp",
    mode: "irradiance",
  };
  const tensors = [...tensorShapes(spec)].map(([name, shape], i): [string, Tensor] => {
    const size = shape.reduce((product, n) => product * n, 1);
    const kind = name.startsWith("mlp.") ? "float" : stored(i);
    if (kind === "float")
      return [name, { shape, stored: { kind, values: new Float32Array(size).map(() => random.next()) } }];
    const halves = (n: number): Uint16Array => new Uint16Array(n).map(() => 0x3000 + random.below(0x1000));
    if (kind === "half") return [name, { shape, stored: { kind, bits: halves(size) } }];
    const codes = new Uint8Array(Math.ceil((size * kind) / 8)).map(() => random.below(256));
    const scales = halves(Math.ceil(size / 7));
    return [name, { shape, stored: { kind: "codes", bits: kind, block: 7, codes, scales } }];
  });
  const frame: FieldFrame = { min: [0, 0, 0], max: [1, 1, 1], scale: 1, quantity: "full" };
  return { spec, frame, tensors: new Map(tensors), provenance: {} };
}

const GRID: HashGridOptions = {
  nLevels: 3,
  log2TableSize: 6,
  nFeatures: 2,
  baseResolution: 3,
  maxResolution: 9,
  fullLevels: false,
  hashAll: false,
  convention: "tiny-cuda-nn",
  primes: [1, 2654435761, 805459861],
};

for (const kind of ["half", "float", 4, 8] as const) {
  for (const nFeatures of [1, 3, 8, 16]) {
    test(`tables of ${nFeatures} features in ${kind} come back out of their textures`, () => {
      expectTables(
        madeUp(new HashGrid({ ...GRID, nFeatures }), () => kind),
        WEBGL2_LIMITS,
      );
      expectTables(
        madeUp(new TriPlane({ resolution: 3, nFeatures, alignCorners: false }), () => kind),
        WEBGL2_LIMITS,
      );
    });
  }
}

test("tables stored in several ways become floats", () => {
  const field = madeUp(new HashGrid(GRID), (i) => (["half", 8, 4] as const)[i % 3] ?? "half");
  assert.equal(planFieldTextures(field, WEBGPU_LIMITS).tables[0]?.entry.bits, 32);
  expectTables(field, WEBGPU_LIMITS);
});

for (const { name } of vectors()) {
  for (const [device, limits] of Object.entries({
    WebGL2: WEBGL2_LIMITS,
    WebGPU: WEBGPU_LIMITS,
    tiny: TINY,
  })) {
    test(`${name} comes back out of its textures on ${device}`, () => {
      expectTables(fieldOf(name), limits);
    });
  }

  test(`${name} has its perceptron in blocks of four by four`, () => {
    const field = fieldOf(name);
    const plan = planFieldTextures(field, WEBGL2_LIMITS);
    const { constants } = packField(field, plan);
    plan.constants.layers.forEach((layer, i) => {
      const weight = tensorValues(field.tensors.get(`mlp.${i}.weight`) ?? assert.fail());
      const bias = tensorValues(field.tensors.get(`mlp.${i}.bias`) ?? assert.fail());
      const inputs = Array.from({ length: layer.nInputs }, (_, j) => Math.sin(j + 1));
      const { blocksIn } = layer;
      for (let row = 0; row < layer.nOutputs; row++) {
        const [block, component] = [Math.floor(row / 4), row % 4];
        let sum = constants[4 * (layer.firstBias + block) + component] ?? Number.NaN;
        let expected = bias[row] ?? Number.NaN;
        for (let j = 0; j < 4 * blocksIn; j++) {
          const vec4 = layer.firstWeight + 4 * (block * blocksIn + Math.floor(j / 4)) + (j % 4);
          sum += (constants[4 * vec4 + component] ?? Number.NaN) * (inputs[j] ?? 0);
          expected += j < layer.nInputs ? (weight[row * layer.nInputs + j] ?? 0) * (inputs[j] ?? 0) : 0;
        }
        assert.equal(sum, expected);
      }
    });
  });
}

test("half precision has its perceptron in texels of two columns", () => {
  for (const { name } of vectors()) {
    const field = fieldOf(name);
    const plan = planFieldTextures(field, WEBGPU_LIMITS, "half");
    const { weights } = packField(field, plan);
    assert.equal(weights?.byteLength, plan.constants.weights?.nBytes);
    const halves = new Uint16Array(weights?.buffer ?? assert.fail());
    plan.constants.layers.forEach((layer, i) => {
      const weight = tensorValues(field.tensors.get(`mlp.${i}.weight`) ?? assert.fail());
      const inRow = (row: number, column: number): number =>
        i
          ? 4 * ((row >> 2) * layer.blocksIn + (column >> 2)) + (column & 3)
          : column * layer.blocksOut + (row >> 2);
      for (let row = 0; row < layer.nOutputs; row++) {
        for (let column = 0; column < layer.nInputs; column++) {
          const found = half(
            halves[8 * layer.firstWeight + 4 * inRow(row, column) + (row & 3)] ?? Number.NaN,
          );
          const value = weight[row * layer.nInputs + column] ?? Number.NaN;
          assert.ok(Math.abs(found - value) <= Math.max(2 ** -11 * Math.abs(value), 2 ** -25));
        }
      }
    });
  }
});

test("tables cost on the GPU what they cost on disk, up to a row", () => {
  const bytes = ["hash-fp32", "hash-fp16", "hash-int8", "hash-int4"].map((name) => {
    return planFieldTextures(fieldOf(name), WEBGPU_LIMITS).tables[0]?.texture.nBytes;
  });
  const grid = fieldOf("hash-fp32").spec.position;
  assert.ok(grid instanceof HashGrid);
  const entries = grid.levels.reduce((sum, level) => sum + level.nEntries, 0);
  [8, 4, 2, 1].forEach((perEntry, i) => {
    const [found, least] = [bytes[i] ?? 0, entries * perEntry];
    assert.ok(found >= least && found < 1.3 * least, `${found} bytes for ${least}`);
  });
});

test("constants leave the uniform buffer when they don't fit", () => {
  const field = fieldOf("hash-int4");
  assert.equal(planFieldTextures(field, WEBGL2_LIMITS).constants.texture, undefined);
  const { texture } = planFieldTextures(field, NO_UNIFORMS).constants;
  assert.deepEqual([texture?.format, texture?.width], ["rgba32float", 256]);
});

test("a field too large for a device is refused with the device's limit", () => {
  const small = { ...TINY, maxSize: 5 };
  refuses(
    () => planFieldTextures(fieldOf("triplane-fp16"), small),
    /position: expected at most 5 × 5 × 256 texels/,
  );
  refuses(() => planFieldTextures(fieldOf("hash-fp16"), { ...TINY, maxSize: 2, maxLayers: 3 }), /× 3 texels/);
});
