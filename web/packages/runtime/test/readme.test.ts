import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { mock, test } from "node:test";
import { everything, glbBytes } from "./glb-file.js";

test("the README's example prints light", async () => {
  const readme = readFileSync(new URL("../README.md", import.meta.url), "utf8");
  const code = /```js\n([\s\S]*?)```/.exec(readme)?.[1] ?? assert.fail("the README has no example");
  assert.ok(code.trim().split("\n").length <= 10, "the example grew");
  const file = new URL("./readme-example.mjs", import.meta.url);
  writeFileSync(file, code);

  // zstddec fetches its own code, as a data: address.
  const { fetch } = globalThis;
  mock.method(globalThis, "fetch", (address: string) =>
    address === "scene.baked.glb" ? new Response(glbBytes(everything()) as BodyInit) : fetch(address),
  );
  const printed = mock.method(console, "log", () => {});
  await import(file.href);
  mock.restoreAll();

  const light: number[] = printed.mock.calls[0]?.arguments.at(0) ?? [];
  assert.equal(light.length, 3);
  assert.ok(light.every((channel) => channel > 0 && Number.isFinite(channel)));
});
