import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import {
  Composite,
  composeText,
  directives,
  ENCODING_TYPES,
  type Encoding,
  type Field,
  fieldShader,
  HashGrid,
  Identity,
  type LightShader,
  type ShaderLanguage,
  type Tensor,
  TriPlane,
  tensorShapes,
  tensorValues,
  WEBGL2_LIMITS,
  WEBGPU_LIMITS,
  withDirect,
} from "@irradia/runtime";
import { refuses } from "./hostile.js";
import { decoder, readAny, vector, vectors } from "./vectors.js";

const LANGUAGES: readonly ShaderLanguage[] = ["wgsl", "glsl"];
const unzstd = await decoder();

function fieldOf(name: string): Field {
  const { file, bytes } = vector(name);
  return readAny(file, bytes, { unzstd });
}

/** Names of functions that a text defines, in its order. */
function functionsOf(text: string, language: ShaderLanguage): string[] {
  const defined = language === "wgsl" ? /^fn (\w+)/gm : /^\w+ (\w+)\([^;]*\) \{$/gm;
  return [...text.matchAll(defined)].map(([, name = ""]) => name);
}

function bound({ textures, uniforms }: LightShader): string[] {
  return [...textures, ...uniforms].map(({ name }) => name);
}

/** A field of zeros. */
function blank(position: Encoding, direction: Encoding): Field {
  const spec = {
    position,
    direction,
    width: 40,
    nHiddenLayers: 1,
    activation: "relu",
    head: "exp",
    mode: "irradiance",
  } as const;
  const tensors = [...tensorShapes(spec)].map(([name, shape]): [string, Tensor] => {
    const size = shape.reduce((product, n) => product * n, 1);
    return [name, { shape, stored: { kind: "half", bits: new Uint16Array(size) } }];
  });
  const frame = { min: [0, 0, 0], max: [1, 1, 1], scale: 1, quantity: "full" } as const;
  return { spec, frame, tensors: new Map(tensors), provenance: {} };
}

const planes = (nFeatures: number) => new TriPlane({ resolution: 4, nFeatures, alignCorners: false });

for (const { name } of vectors()) {
  for (const language of LANGUAGES) {
    test(`${name} in ${language} has all that it uses, each once`, () => {
      const shader = fieldShader(fieldOf(name), WEBGL2_LIMITS);
      const text = shader.text(language);
      const functions = functionsOf(text, language);
      assert.equal(new Set(functions).size, functions.length);
      for (const called of [shader.entry, ...Object.values(shader.views)])
        assert.ok(functions.includes(called));
      for (const used of new Set(text.match(/\birradia_\w+/g))) {
        if (bound(shader).includes(used)) continue;
        const declared = new RegExp(`^(?:[a-z]\\w*(?:<private>)? )+${used}\\b`, "m").exec(text);
        assert.ok(declared, used);
        // GLSL knows what it has read; WGSL knows all.
        const isFirst = declared.index + declared[0].length === text.search(`\\b${used}\\b`) + used.length;
        assert.ok(isFirst || language === "wgsl", used);
      }
    });
  }
}

test("every name of a text begins with irradia_", () => {
  for (const { name } of vectors()) {
    const text = fieldShader(fieldOf(name), WEBGPU_LIMITS).text("wgsl");
    const declared = [...text.matchAll(/^(?:fn|const|struct|var<private>) (\w+)/gm)].map(
      ([, each = ""]) => each,
    );
    assert.ok(declared.length > 10);
    for (const each of declared) assert.match(each, /^irradia_/);
  }
});

test("fields of one architecture have one text", () => {
  const [first, second] = ["hash-fp16", "hash-full-levels"].map((name) =>
    fieldShader(fieldOf(name), WEBGPU_LIMITS).text("wgsl"),
  );
  assert.equal(first, second);
  assert.notEqual(first, fieldShader(fieldOf("hash-int8"), WEBGPU_LIMITS).text("wgsl"));
});

test("constants move to a texture where they don't fit, and with them the piece that reads them", () => {
  const field = fieldOf("hash-fp16");
  const small = fieldShader(field, { ...WEBGL2_LIMITS, maxUniformBytes: 16 });
  assert.deepEqual(small.uniforms, []);
  assert.deepEqual(bound(small), ["irradia_table", "irradia_constants"]);
  assert.match(small.text("glsl"), /texelFetch\(irradia_constants/);
  const large = fieldShader(field, WEBGL2_LIMITS);
  assert.deepEqual(bound(large), ["irradia_table", "irradia_constants"]);
  assert.equal(large.uniforms.length, 1);
  assert.doesNotMatch(large.text("glsl"), /texelFetch\(irradia_constants/);
  assert.ok(small.cost.fetches > large.cost.fetches);
});

test("a second table has pieces of its own, and shares the rest", () => {
  const field = blank(
    new Composite([planes(2), new Composite([planes(16), new Identity()])]),
    new Identity(),
  );
  const shader = fieldShader(field, WEBGL2_LIMITS);
  assert.deepEqual(bound(shader), ["irradia_table", "irradia_table_b", "irradia_constants"]);
  const functions = functionsOf(shader.text("wgsl"), "wgsl");
  for (const name of ["irradia_table_tri_plane", "irradia_table_b_tri_plane", "irradia_push"])
    assert.equal(functions.filter((each) => each === name).length, 1, name);
  const words = [...shader.text("wgsl").matchAll(/const irradia_table\w*_words: u32 = (\d)u/g)];
  assert.deepEqual(
    words.map(([, count]) => count),
    ["1", "4"],
  );
});

const HALF = { precision: "half" } as const;

test("half precision is a choice of pieces, and says what it needs", () => {
  for (const { name } of vectors()) {
    const shader = fieldShader(fieldOf(name), WEBGPU_LIMITS, HALF);
    const text = shader.text("wgsl");
    assert.deepEqual(shader.requires, ["shader-f16"]);
    assert.equal(directives(shader), "enable f16;\n");
    assert.doesNotMatch(text, /enable/);
    assert.match(text, /array<vec4h, 4>/);
    const functions = functionsOf(text, "wgsl");
    assert.equal(new Set(functions).size, functions.length);
    for (const called of [shader.entry, ...Object.values(shader.views)])
      assert.ok(functions.includes(called));
  }
});

test("floats need nothing", () => {
  const shader = fieldShader(fieldOf("hash-fp16"), WEBGPU_LIMITS);
  assert.equal(shader.requires, undefined);
  assert.equal(directives(shader), "");
  assert.doesNotMatch(shader.text("wgsl"), /vec4h/);
});

test("half precision has no GLSL", () => {
  const shader = fieldShader(fieldOf("hash-fp16"), WEBGL2_LIMITS, HALF);
  refuses(() => shader.text("glsl"), /expected WGSL, HLSL or MSL for half precision, found GLSL/);
});

test("a direct map on top keeps what a shader requires", () => {
  const field = fieldOf("hash-fp16");
  const indirect = { ...field, frame: { ...field.frame, quantity: "indirect" } } as const;
  const map = { width: 1, height: 1, layers: 1, encoding: "rgb9e5", texels: new Uint32Array(1) } as const;
  const shader = fieldShader(indirect, WEBGPU_LIMITS, HALF);
  assert.deepEqual(withDirect(shader, map, 1, WEBGPU_LIMITS).requires, ["shader-f16"]);
});

test("weights beyond half floats are refused", () => {
  const field = fieldOf("hash-fp32");
  const weight = field.tensors.get("mlp.1.weight") ?? assert.fail();
  const values = Float32Array.from(tensorValues(weight));
  values[3] = 70000;
  const tensors = new Map(field.tensors).set("mlp.1.weight", {
    shape: weight.shape,
    stored: { kind: "float", values },
  });
  const large = { ...field, tensors };
  assert.ok(fieldShader(large, WEBGPU_LIMITS));
  refuses(() => fieldShader(large, WEBGPU_LIMITS, HALF), /at most 65504.*found 70000/);
});

test("more tables than fragment shaders have textures are refused", () => {
  const nine = new Composite(Array.from({ length: 9 }, () => planes(2)));
  refuses(
    () => fieldShader(blank(nine, new Identity()), WEBGL2_LIMITS),
    /at most 8 encodings that learn, found 9/,
  );
});

test("a choice that nobody made is an error of ours", () => {
  assert.throws(() => composeText("wgsl", ["perceptron"]), /nothing was chosen/);
});

test("every encoding can be drawn", () => {
  const seen = new Set<string>();
  const visit = (encoding: Encoding): void => {
    seen.add(encoding.type);
    if (encoding instanceof Composite) encoding.parts.forEach(visit);
  };
  for (const { name } of vectors()) {
    const field = fieldOf(name);
    fieldShader(field, WEBGL2_LIMITS);
    visit(field.spec.position);
    if (field.spec.direction) visit(field.spec.direction);
  }
  assert.deepEqual([...seen].sort(), [...ENCODING_TYPES].sort());
});

test("costs are those of formulas", () => {
  const grid = fieldOf("hash-fp16");
  const { spec } = grid;
  assert.ok(spec.position instanceof HashGrid);
  const { nLevels, nFeatures } = spec.position.options;
  const sizes = [spec.position.nOutputs + 3, 8, 8, 3];
  const network = [0, 1, 2].reduce((sum, i) => sum + (2 * (sizes[i] ?? 0) + 1) * (sizes[i + 1] ?? 0), 0);
  const { cost } = fieldShader(grid, WEBGPU_LIMITS);
  assert.equal(cost.flops, 16 * nLevels * nFeatures + 16 * nLevels + network + 2 * 8);
  assert.equal(cost.fetches, 8 * nLevels);
  const bytes = fieldShader(fieldOf("hash-int8"), WEBGPU_LIMITS).cost.bytes;
  assert.ok(bytes < cost.bytes);
});

test("the README's example of calls is what is made", () => {
  const readme = readFileSync(new URL("../../../../shaders/README.md", import.meta.url), "utf8");
  const text = fieldShader(fieldOf("sh"), WEBGPU_LIMITS).text("wgsl");
  const call = /^irradia_spherical_harmonics\(\d+u, normal \* 0\.5 \+ 0\.5\);$/m;
  assert.match(readme, call);
  assert.match(text, call);
});
