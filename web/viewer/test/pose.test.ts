import assert from "node:assert/strict";
import { test } from "node:test";
import { framePose, isSamePose, poseFromMatrix, readPose, writePose } from "../src/camera/pose.js";

const BOX = { min: [-1, 0, -2], max: [3, 2, 2] } as const;

test("a matrix looks along its −Z", () => {
  const turned = [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 1, 2, 1]; // back is +X
  const pose = poseFromMatrix(turned, Math.PI / 2, 4);
  assert.deepEqual(pose, { eye: [5, 1, 2], target: [1, 1, 2], yfovDeg: 90 });
});

test("a framed box is inside the picture, wide or high", () => {
  for (const aspect of [2, 0.5]) {
    const { eye, target, yfovDeg } = framePose(BOX, aspect);
    const distance = Math.hypot(...eye.map((x, i) => x - (target[i] ?? 0)));
    const half = Math.atan(Math.min(1, aspect) * Math.tan((yfovDeg * Math.PI) / 360));
    assert.ok(distance * Math.sin(half) > Math.hypot(4, 2, 4) / 2 - 1e-9);
  }
});

test("a pose comes back from its text", () => {
  const pose = framePose(BOX, 1.5);
  const back = readPose(writePose(pose));
  assert.ok(back && isSamePose(pose, back));
});

test("a scene of millimetres is seen from the same place by its link", () => {
  const small = { min: [0, 0, 0], max: [0.0012, 0.0007, 0.0009] } as const;
  const pose = framePose(small, 1.5);
  const back = readPose(writePose(pose));
  assert.ok(back && isSamePose(pose, back));
  assert.ok(!isSamePose(pose, { ...pose, eye: [pose.eye[0] + 5e-5, pose.eye[1], pose.eye[2]] }));
});

test("poses that look elsewhere, from elsewhere, or wider are others", () => {
  const pose = framePose(BOX, 1);
  const [x, y, z] = pose.eye;
  assert.ok(!isSamePose(pose, { ...pose, eye: [x + 0.1, y, z] }));
  assert.ok(!isSamePose(pose, { ...pose, target: [0, 0, 0] }));
  assert.ok(!isSamePose(pose, { ...pose, yfovDeg: pose.yfovDeg + 1 }));
});
