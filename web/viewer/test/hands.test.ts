import assert from "node:assert/strict";
import { test } from "node:test";
import { Look } from "../src/camera/look.js";
import { Patience } from "../src/state/patience.js";
import { differenceOf } from "../src/view/difference.js";

Object.assign(globalThis, { window: new EventTarget(), Element: class {} });

interface Pad {
  readonly look: Look;
  send(type: string, properties: object): Event;
}

function pad(): Pad {
  const element = Object.assign(new EventTarget(), { setPointerCapture: () => {} });
  const look = new Look(element as unknown as HTMLElement, () => {});
  const send = (type: string, properties: object): Event => {
    const event = Object.assign(new Event(type, { cancelable: true }), properties);
    element.dispatchEvent(event);
    return event;
  };
  return { look, send };
}

const finger = (pointerId: number, clientX: number, clientY: number): object => ({
  pointerId,
  clientX,
  clientY,
  pointerType: "touch",
  button: 0,
});
const near = (one: readonly number[], other: readonly number[]): void =>
  one.forEach((value, i) => {
    assert.ok(Math.abs(value - (other[i] ?? 0)) < 1e-9, `${one} ≠ ${other}`);
  });

test("one finger looks, two fingers walk", () => {
  const { look, send } = pad();
  send("pointerdown", finger(1, 0, 0));
  send("pointermove", finger(1, 10, 0));
  const looked = look.take();
  assert.ok(looked.yaw !== 0);
  near(looked.stride, [0, 0, 0]);
  send("pointerdown", finger(2, 50, 50));
  send("pointermove", finger(1, 10, 20));
  send("pointermove", finger(2, 50, 70));
  const walked = look.take();
  assert.equal(walked.yaw, 0);
  assert.ok(walked.stride[2] > 0 && walked.stride[0] === 0);
});

test("what two fingers ask for doesn't depend on how often frames are drawn", () => {
  const stride = (framesApart: number): number[] => {
    const { look, send } = pad();
    send("pointerdown", finger(1, 0, 0));
    send("pointerdown", finger(2, 9, 9));
    const sum = [0, 0, 0];
    for (let y = 1; y <= 12; y += 1) {
      send("pointermove", finger(1, -y, y));
      if (y % framesApart > 0) continue;
      for (const [axis, x] of look.take().stride.entries()) sum[axis] = (sum[axis] ?? 0) + x;
    }
    return sum;
  };
  near(stride(1), stride(12));
});

test("the right button walks, and opens no menu", () => {
  const { look, send } = pad();
  send("pointerdown", { pointerId: 1, clientX: 0, clientY: 0, button: 2 });
  send("pointermove", { pointerId: 1, clientX: 5, clientY: 10, button: -1 });
  const { yaw, pitch, stride } = look.take();
  assert.deepEqual([yaw, pitch], [0, 0]);
  assert.ok(stride[2] > 0 && stride[0] < 0);
  assert.ok(send("contextmenu", {}).defaultPrevented);
});

test("three losses within half a minute are borne, a fourth isn't", () => {
  const patience = new Patience(3, 30_000);
  assert.deepEqual(
    [0, 10, 20, 29_000].map((now) => patience.allows(now)),
    [true, true, true, false],
  );
  assert.ok(new Patience(1, 100).allows(0));
  const slow = new Patience(1, 100);
  assert.deepEqual(
    [0, 100, 200].map((now) => slow.allows(now)),
    [true, true, true],
  );
});

test("pictures without a pixel in common have no difference", () => {
  assert.equal(differenceOf([0, 0, 0, 0, 0.5, 1, 0, 0]), null);
  assert.deepEqual(differenceOf([0.5, 0.01, 0, 1, 9, 9, 9, 0]), { flip: 0.5, psnrDb: 20 });
  assert.equal(differenceOf([0, 0, 0, 1])?.psnrDb, Number.POSITIVE_INFINITY);
});
