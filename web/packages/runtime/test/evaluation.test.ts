import assert from "node:assert/strict";
import { test } from "node:test";
import { FieldEvaluator } from "@irradia/runtime";
import { decoder, readAny, vectors } from "./vectors.js";

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
