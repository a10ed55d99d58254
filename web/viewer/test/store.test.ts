import assert from "node:assert/strict";
import { test } from "node:test";
import { Store } from "../src/state/store.js";

test("listeners hear of changes, and of nothing else", () => {
  const store = new Store({ a: 1, b: "x" });
  const heard: unknown[] = [];
  const end = store.subscribe((now, before) => heard.push([now.a, before.a]));
  store.set({ a: 1 });
  store.set({ a: 2, b: "x" });
  end();
  store.set({ a: 3 });
  assert.deepEqual(heard, [[2, 1]]);
});

test("a watcher is told at once, and when what it selects changes", () => {
  const store = new Store({ a: 1, b: 1 });
  const heard: number[] = [];
  store.watch(
    ({ a }) => a,
    (a) => heard.push(a),
  );
  store.set({ b: 2 });
  store.set({ a: 5 });
  assert.deepEqual(heard, [1, 5]);
});

test("a listener that sets something is heard by the others once each", () => {
  const store = new Store({ a: 0, twice: 0 });
  store.subscribe(({ a }) => store.set({ twice: 2 * a }));
  const heard: number[] = [];
  store.watch(
    ({ twice }) => twice,
    (twice) => heard.push(twice),
  );
  store.set({ a: 2 });
  assert.deepEqual(heard, [0, 4]);
});
