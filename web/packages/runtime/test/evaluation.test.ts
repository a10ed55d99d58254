import assert from "node:assert/strict";
import { test } from "node:test";
import { FieldEvaluator } from "@irradia/runtime";
import { refuses } from "./hostile.js";
import { decoder, readAny, vector, vectors } from "./vectors.js";

const TOLERANCE = 1e-5; // of the largest value
const unzstd = await decoder();

function expectNear(found: ArrayLike<number>, expected: number[], what: string): void {
  assert.equal(found.length, expected.length, what);
  const largest = Math.max(...expected.map(Math.abs));
  expected.forEach((value, i) => {
    const error = Math.abs((found[i] ?? Number.NaN) - value);
    assert.ok(error <= TOLERANCE * largest, `${what}: ${found[i]} is not ${value}`);
  });
}

for (const vector of vectors()) {
  test(`${vector.name} gives the reference's irradiance`, () => {
    const light = new FieldEvaluator(readAny(vector.file, vector.bytes, { unzstd }));
    assert.equal(light.field.frame.scale, vector.scale);
    const found = vector.positions.map((p, i) => light.irradiance(p, vector.normals[i] ?? [0, 0, 0]));
    expectNear(found.flat(), vector.irradiance.flat(), vector.name);
  });
  if (vector.coefficients) {
    test(`${vector.name} gives the reference's coefficients`, () => {
      const light = new FieldEvaluator(readAny(vector.file, vector.bytes, { unzstd }));
      const found = vector.positions.map((p) => [...light.coefficients(p)]);
      expectNear(found.flat(), vector.coefficients?.flat(2) ?? [], vector.name);
    });
  }
}

test("a field of irradiance has no coefficients to give", () => {
  const { file, bytes } = vector("hash-fp16");
  const light = new FieldEvaluator(readAny(file, bytes, {}));
  refuses(() => light.coefficients([0, 1, 2]), /gives irradiance, not SH coefficients/);
});

test("places outside of the box have the light of its edge", () => {
  const { file, bytes } = vector("triplane-fp16");
  const light = new FieldEvaluator(readAny(file, bytes, {}));
  const [x, y, z] = light.field.frame.max;
  assert.deepEqual(light.irradiance([x + 3, y + 1, z], [0, 1, 0]), light.irradiance([x, y, z], [0, 1, 0]));
});
