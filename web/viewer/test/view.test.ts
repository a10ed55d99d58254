import assert from "node:assert/strict";
import { test } from "node:test";
import { unshoulder } from "../src/files/shoulder.js";
import { automaticEv, stops } from "../src/view/exposure.js";
import { colourKernels, featureKernels } from "../src/view/flip-kernels.js";
import { choicesOf, resolveSides } from "../src/view/sources.js";

const sum = (values: readonly number[] = []): number => values.reduce((total, value) => total + value, 0);
const near = (one: number, other: number): void =>
  assert.ok(Math.abs(one - other) < 1e-9, `${one} ≠ ${other}`);

test("automatic exposure makes the geometric mean of luminances middle grey", () => {
  near(automaticEv([0.18, 0.18, 0.18, 1]), 0);
  near(automaticEv([0.09, 0.09, 0.09, 1, 0.36, 0.36, 0.36, 1]), 0);
  near(automaticEv([0.72, 0.72, 0.72, 1, 9, 9, 9, 0, 0, 0, 0, 1, Number.NaN, 1, 1, 1]), -2);
  assert.equal(automaticEv([0, 0, 0, 1]), 0);
});

test("stops have a sign", () => {
  assert.equal(stops(0), "+0.0 EV");
  assert.equal(stops(-1.26), "−1.3 EV");
});

test("FLIP's filters keep a flat colour and see no edge in it", () => {
  const { radius, taps, shares } = colourKernels();
  assert.equal(radius, 10);
  for (const row of taps) near(sum(row), 1);
  near(sum(shares), 1);
  const [bell, slope, curvature] = featureKernels().taps;
  near(sum(bell), 1);
  near(sum(slope), 0);
  near(sum(curvature), 0);
});

test("the shoulder of our pictures is undone", () => {
  for (const light of [0, 0.2, 0.5, 0.8, 2]) {
    const shown = light > 0.5 ? 1 - 0.5 * Math.exp(1 - 2 * light) : light;
    assert.ok(Math.abs(unshoulder(shown) - light) < 1e-6);
  }
});

const CHOICES = choicesOf(
  [
    { name: "lightmap", kind: "lightmap" },
    { name: "field:small", kind: "field" },
    { name: "none", kind: "none" },
  ],
  [{ id: "reference", label: "Path traced" }],
);

test("sides are what was asked for, else the best that differ", () => {
  const ids = (left: string, right: string) => resolveSides(CHOICES, left, right).map((side) => side?.id);
  assert.deepEqual(ids("field:small", "lightmap"), ["field:small", "lightmap"]);
  assert.deepEqual(ids("", ""), ["lightmap", "reference"]);
  assert.deepEqual(ids("reference", "gone"), ["reference", "lightmap"]);
  assert.deepEqual(ids("none", "none"), ["none", "none"]);
});

test("choices are named for people", () => {
  assert.deepEqual(
    CHOICES.map(({ label }) => label),
    ["Lightmap", "Neural field · small", "No baked light", "Path traced"],
  );
});
