import assert from "node:assert/strict";
import { test } from "node:test";
import { DEFAULTS, type ViewerState } from "../src/state/state.js";
import { readPageOptions, readState, writeState } from "../src/state/url.js";

const OTHERWISE: ViewerState = {
  scene: "files/a b&c.glb",
  field: "field.safetensors.zst",
  environment: "sky.hdr",
  left: "field:0",
  right: "reference",
  compare: "error",
  split: 0.25,
  gain: 32,
  view: "hidden",
  surfaces: "materials",
  ev: -1.5,
  tone: "agx",
  camera: { eye: [1, 2.5, -3], target: [0, 1, 0.125], yfovDeg: 39.3076 },
  navigation: "walk",
  probes: "direction",
  object: "knot",
  place: [0.5, -1, 2],
  pass: "half",
  panel: false,
};

test("every key of a state comes back from its URL", () => {
  for (const key of Object.keys(DEFAULTS)) {
    const name = key as keyof ViewerState;
    assert.notDeepEqual(OTHERWISE[name], DEFAULTS[name], `${key} is not tested`);
  }
  assert.deepEqual(readState("", `#${writeState(OTHERWISE)}`), OTHERWISE);
});

test("a state as it is by default needs no URL", () => {
  assert.equal(writeState(DEFAULTS), "");
  assert.deepEqual(readState("", ""), DEFAULTS);
});

test("what was said before the hash can be taken back behind it", () => {
  const search = "?left=lightmap&tone=aces&camera=0,0,0,0,0,1&place=1,2,3&env=sky.hdr&panel=0&ev=2";
  const base = readState(search, "");
  const hash = writeState(DEFAULTS, base);
  assert.deepEqual(readState(search, hash), DEFAULTS);
  assert.equal(writeState(base, base), "");
  assert.deepEqual(readState(search, writeState(OTHERWISE, base)), OTHERWISE);
});

test("nonsense behind the hash leaves what was said before it", () => {
  assert.equal(readState("?tone=aces", "#tone=pink").tone, "aces");
});

test("what stands behind the hash wins over the query", () => {
  assert.equal(readState("?left=lightmap&tone=aces", "#left=probes").left, "probes");
  assert.equal(readState("?left=lightmap&tone=aces", "#left=probes").tone, "aces");
});

test("values that make no sense leave the default", () => {
  const nonsense =
    "?compare=both&split=2&gain=0&view=9&surfaces=both&ev=bright&camera=1,2&place=1,2,x&panel=yes&tone=";
  assert.deepEqual(readState(nonsense, ""), DEFAULTS);
  assert.deepEqual(readState("?camera=0,0,0,0,0,0,45", "").camera, undefined);
});

test("source and exposure are other names of left and ev", () => {
  const state = readState("?source=probes&exposure=auto", "");
  assert.equal(state.left, "probes");
  assert.equal(state.ev, "auto");
});

test("a bare number of a view is the number of a pose", () => {
  assert.deepEqual(readPageOptions("?kiosk=1&view=2&renderer=webgl2"), {
    kiosk: true,
    backend: "webgl2",
    pose: 2,
  });
  assert.deepEqual(readPageOptions("?view=depth&renderer=best"), {
    kiosk: false,
    backend: "auto",
    pose: undefined,
  });
});
