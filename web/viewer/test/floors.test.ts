import assert from "node:assert/strict";
import { test } from "node:test";
import { Floors } from "../src/camera/floors.js";

type Xyz = readonly [number, number, number];

/** A square of two triangles, from one corner along two sides. */
const square = (at: Xyz, one: Xyz, other: Xyz): number[] => {
  const plus = (a: Xyz, b: Xyz): Xyz => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const far = plus(plus(at, one), other);
  return [at, plus(at, one), far, at, far, plus(at, other)].flat();
};
const ROOM = new Floors(
  new Float32Array([
    ...square([0, 0, 0], [4, 0, 0], [0, 0, 6]),
    ...square([0, 3, 0], [4, 0, 0], [0, 0, 6]),
    ...square([4, 0, 0], [0, 3, 0], [0, 0, 6]),
    ...square([1, 0.5, 1], [1, 0, 0], [0, 0, 1]), // a table
  ]),
);
const close = (one: number | undefined, other: number): void =>
  assert.ok(Math.abs((one ?? Number.NaN) - other) < 1e-6, `${one} ≠ ${other}`);

test("the floor is below, the ceiling above, a table in between", () => {
  close(ROOM.distance([3, 1, 3], [0, -1, 0]), 1);
  close(ROOM.distance([3, 1, 3], [0, 1, 0]), 2);
  close(ROOM.distance([1.5, 1.25, 1.5], [0, -1, 0]), 0.75);
});

test("a wall stops, unless it is farther than anyone cares", () => {
  close(ROOM.distance([1, 1, 3], [1, 0, 0]), 3);
  close(ROOM.distance([3.9, 1, 3], [1, 0, 0], 0.2), 0.1);
  assert.equal(ROOM.distance([3, 1, 3], [1, 0, 0], 0.5), undefined);
  assert.equal(ROOM.distance([3, 1, 3], [-1, 0, 0]), undefined);
});

test("outside there is nothing", () => {
  assert.equal(ROOM.distance([9, 1, 3], [0, -1, 0]), undefined);
  assert.equal(new Floors(new Float32Array(0)).distance([0, 0, 0], [0, -1, 0]), undefined);
});

test("it finds what a search through all triangles finds", () => {
  let seed = 1;
  const random = (): number => {
    seed = (seed * 48271) % 2147483647;
    return seed / 2147483647;
  };
  const corners = new Float32Array(9 * 300);
  for (let i = 0; i < 300; i += 1) {
    const place = [5 * random(), 5 * random(), 5 * random()];
    for (let k = 0; k < 9; k += 1) corners[9 * i + k] = (place[k % 3] ?? 0) + random();
  }
  const all = new Floors(corners);
  let nHits = 0;
  for (let n = 0; n < 500; n += 1) {
    const from: Xyz = [5 * random(), 5 * random(), 5 * random()];
    const angle = 7 * random();
    const way: Xyz = n % 2 ? [0, -1, 0] : [Math.cos(angle), 0, Math.sin(angle)];
    const each = Array.from(
      { length: 300 },
      (_, i) =>
        new Floors(corners.subarray(9 * i, 9 * i + 9)).distance(from, way) ?? Number.POSITIVE_INFINITY,
    );
    const nearest = Math.min(...each);
    nHits += Number.isFinite(nearest) ? 1 : 0;
    assert.equal(all.distance(from, way) ?? Number.POSITIVE_INFINITY, nearest);
  }
  assert.ok(nHits > 50);
});

test("triangles as large as the plan are found, and take no more room than others", () => {
  const corners = new Float32Array(9 * 20_000);
  for (let i = 0; i < 20_000; i += 1) {
    const y = i / 20_000;
    corners.set([0, y, 0, 100, y, 0, 0, y, 100], 9 * i);
  }
  close(new Floors(corners).distance([20, 2, 20], [0, -1, 0]), 2 - 19_999 / 20_000);
});
