import assert from "node:assert/strict";
import { test } from "node:test";
import { Queue, type Work } from "../src/state/queue.js";

const turns = async (n: number): Promise<void> => {
  for (let i = 0; i < n; i += 1) await Promise.resolve();
};

test("work asked for at once is done one piece after another, and told once when all is done", async () => {
  const heard: string[] = [];
  const queue = new Queue(() => heard.push("idle"));
  const piece =
    (name: string, length: number): Work =>
    async () => {
      heard.push(`${name} begins`);
      await turns(length);
      heard.push(`${name} ends`);
    };
  await Promise.all([queue.add(piece("long", 20)), queue.add(piece("short", 1))]);
  assert.deepEqual(heard, ["long begins", "long ends", "short begins", "short ends", "idle"]);
});

test("a piece that fails keeps no other from being done", async () => {
  const heard: string[] = [];
  const queue = new Queue(() => {});
  const failing = queue.add(() => Promise.reject(new Error("no")));
  await queue.add(async () => {
    heard.push("next");
  });
  await failing;
  assert.deepEqual(heard, ["next"]);
});

test("what is abandoned hears of it, and what waited behind it is left out", async () => {
  const heard: string[] = [];
  const queue = new Queue(() => heard.push("idle"));
  const first = queue.add(async (signal) => {
    await turns(10);
    heard.push(signal.aborted ? "ended" : "done");
  });
  const waiting = queue.add(async () => {
    heard.push("too late");
  });
  await turns(3);
  queue.abandon();
  await queue.add(async (signal) => {
    heard.push(signal.aborted ? "ended" : "new");
  });
  await Promise.all([first, waiting]);
  assert.deepEqual(heard, ["ended", "new", "idle"]);
});
