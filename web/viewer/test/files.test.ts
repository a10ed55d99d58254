import assert from "node:assert/strict";
import { test } from "node:test";
import { InputError } from "@irradia/runtime";
import { readCameraFile } from "../src/files/camera-file.js";
import { fileName, isPanorama, kindOf } from "../src/files/kinds.js";
import { readManifest } from "../src/files/manifest.js";
import { problemOf } from "../src/files/problem.js";
import { readRadianceHdr } from "../src/files/radiance.js";

const bytes = (text: string): Uint8Array => new TextEncoder().encode(text);

test("first bytes tell what a file is, names only where they don't", () => {
  assert.equal(kindOf({ name: "renamed.bin", bytes: bytes("glTF....") }), "scene");
  assert.equal(kindOf({ name: "x", bytes: Uint8Array.of(0x28, 0xb5, 0x2f, 0xfd) }), "field");
  assert.equal(kindOf({ name: "x", bytes: bytes("#?RADIANCE\n") }), "environment-or-picture");
  assert.equal(kindOf({ name: "x.txt", bytes: Uint8Array.of(0x89, 0x50, 0x4e, 0x47) }), "picture");
  assert.equal(kindOf({ name: "F.SAFETENSORS", bytes: bytes("") }), "field");
  assert.equal(kindOf({ name: "weights.bin", bytes: bytes("") }), "field-bin");
  assert.equal(kindOf({ name: "notes.txt", bytes: bytes("hello") }), "unknown");
});

test("a panorama is twice as wide as high", () => {
  assert.ok(isPanorama(2048, 1024));
  assert.ok(!isPanorama(1920, 1080));
});

test("a name is the last part of an address", () => {
  assert.equal(fileName("files/0/my%20room.glb?v=2#x"), "my room.glb");
  assert.equal(fileName("100%.glb"), "100%.glb");
});

test("addresses in a manifest are relative to it, and cameras become poses", () => {
  const text = JSON.stringify({
    format: "irradia-manifest",
    version: 1,
    title: "room",
    scenes: [
      {
        name: "room",
        url: "room.glb",
        fields: [{ name: "small", url: "f.bin" }],
        references: [
          {
            name: "traced",
            url: "r.hdr",
            kind: "hdr",
            camera: { worldFromCamera: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1], yfovRad: 1 },
          },
        ],
      },
    ],
    later: "keys are left alone",
  });
  const [scene] = readManifest(text, "manifest.json", "site/").scenes;
  assert.equal(scene?.url, "site/room.glb");
  assert.equal(scene?.fields[0]?.url, "site/f.bin");
  assert.deepEqual(scene?.references[0]?.pose?.eye, [0, 0, 5]);
});

test("a damaged manifest says what it isn't", () => {
  for (const text of ["{", "[]", '{"format": "irradia-manifest", "version": 2}', "null"]) {
    assert.throws(() => readManifest(text, "m.json"), InputError);
  }
  const noUrl = '{"format": "irradia-manifest", "version": 1, "scenes": [{}]}';
  assert.throws(() => readManifest(noUrl, "m.json"), /expected a url/);
});

test("a saved camera is read by rows", () => {
  const world_from_camera = [
    [1, 0, 0, 7],
    [0, 1, 0, 8],
    [0, 0, 1, 9],
    [0, 0, 0, 1],
  ];
  const file = { name: "c.json", bytes: bytes(JSON.stringify({ world_from_camera, yfov_deg: 40 })) };
  const { eye, target, yfovDeg } = readCameraFile(file, 2);
  assert.deepEqual(
    [eye, target],
    [
      [7, 8, 9],
      [7, 8, 7],
    ],
  );
  assert.ok(Math.abs(yfovDeg - 40) < 1e-9);
  assert.throws(() => readCameraFile({ name: "c.json", bytes: bytes("{}") }, 2), InputError);
});

test("a problem says what was found, where, and what to do", () => {
  const problem = problemOf(
    new InputError("expected 4 bytes, found 3", "/buffers/0", "Write it again."),
    "a.glb",
  );
  assert.deepEqual(problem, {
    title: "Can't open a.glb",
    finding: "Expected 4 bytes, found 3.",
    where: "/buffers/0",
    fix: "Write it again.",
  });
  assert.equal(problemOf("oops", "a.glb").finding, "Oops.");
});

const HEADER = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 1 +X 8\n";
const picture = (...row: number[]): Uint8Array => Uint8Array.of(...bytes(HEADER), ...row);
const PACKED = [2, 2, 0, 8, 136, 128, 136, 64, 3, 1, 2, 3, 133, 9, 136, 129];

test("runs and single bytes of a Radiance row are unpacked, and its exposure undone", () => {
  const { width, height, linear } = readRadianceHdr(picture(...PACKED), "p.hdr");
  assert.deepEqual([width, height], [8, 1]);
  assert.deepEqual([...linear.subarray(0, 4)], [0.5, 0.25, 1 / 256, 1]);
  assert.deepEqual([...linear.subarray(12, 16)], [0.5, 0.25, 9 / 256, 1]);
});

test("a Radiance picture that is cut anywhere is refused", () => {
  const whole = picture(...PACKED);
  for (let n = 0; n < whole.length; n += 1) {
    assert.throws(() => readRadianceHdr(whole.subarray(0, n), "p.hdr"), InputError, `cut at ${n}`);
  }
});
