import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

const css = readFileSync(new URL("../../src/style/tokens.css", import.meta.url), "utf8");
const colour = (name: string): number[] => {
  const [, hex = ""] = new RegExp(`--${name}: #([0-9a-f]{6});`).exec(css) ?? [];
  assert.ok(hex, `--${name} is not there`);
  return [0, 2, 4].map((at) => Number.parseInt(hex.slice(at, at + 2), 16) / 255);
};
const luminance = (name: string): number => {
  const [r = 0, g = 0, b = 0] = colour(name).map((x) =>
    x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4,
  );
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
/** WCAG 2.2's. */
const contrast = (one: string, other: string): number => {
  const [low = 0, high = 0] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
};

test("words and the edges of controls stand out from what they stand on", () => {
  for (const ground of ["ground", "surface"]) {
    for (const words of ["text", "dim", "faint", "accent"]) {
      assert.ok(contrast(words, ground) >= 4.5, `--${words} on --${ground}`);
    }
    assert.ok(contrast("edge", ground) >= 3, `--edge on --${ground}`);
  }
});
