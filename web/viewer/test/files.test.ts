import assert from "node:assert/strict";
import { test } from "node:test";
import { InputError } from "@irradia/runtime";
import { bytesBySlices, bytesFromBase64 } from "../src/files/bytes.js";
import { readCameraFile } from "../src/files/camera-file.js";
import { fileName, isKnownName, isPanorama, kindOf, wholeBuffer } from "../src/files/kinds.js";
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

test("base64 of any length gives its bytes, with line ends in it or not", () => {
  for (const length of [0, 1, 2, 3, 3 * 2 ** 18 - 1, 3 * 2 ** 18, 3 * 2 ** 18 + 1]) {
    const wanted = Uint8Array.from({ length }, (_, i) => (i * 7919) >> 3);
    const text = `\n${Buffer.from(wanted).toString("base64").replace(/.{76}/g, "$&\n")}\n`;
    assert.ok(Buffer.from(bytesBySlices(text)).equals(wanted), `${length} bytes`);
    assert.ok(Buffer.from(bytesFromBase64(text, "x")).equals(wanted), `${length} bytes`);
  }
  assert.throws(() => bytesFromBase64("a*b!", "x"), InputError);
});

test("a hundred megabytes of base64 are no more than that in memory", () => {
  const text = "QUJD".repeat(2 ** 25);
  assert.equal(bytesBySlices(text).length, 3 * 2 ** 25);
});

test("bytes are copied for a loader only where they are part of something larger", () => {
  const whole = new Uint8Array(8);
  assert.equal(wholeBuffer(whole), whole.buffer);
  assert.equal(wholeBuffer(whole.subarray(2, 5)).byteLength, 3);
});

test("files in a folder are known by their names", () => {
  assert.deepEqual(["a.GLB", "b.safetensors.zst", "c.txt", "glb"].map(isKnownName), [
    true,
    true,
    false,
    false,
  ]);
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
  const wide = { name: "c.json", bytes: bytes(JSON.stringify({ world_from_camera, yfov_deg: 180 })) };
  assert.throws(() => readCameraFile(wide, 2), /170 degrees/);
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

test("a few bytes that promise a huge picture are refused before room is made for it", () => {
  const text = "#?RADIANCE\n\n-Y 4096 +X 32767\n";
  assert.throws(() => readRadianceHdr(bytes(text), "p.hdr"), /more pixels/);
});

test("a picture of one colour, packed as well as can be, is read", () => {
  const row = [2, 2, 1, 0, ...[0, 0, 0, 0].flatMap((value) => [255, value, 255, value, 130, value])];
  const file = Uint8Array.of(...bytes("#?RADIANCE\n\n-Y 2 +X 256\n"), ...row, ...row);
  assert.equal(readRadianceHdr(file, "p.hdr").width, 256);
});
