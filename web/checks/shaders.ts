/**
 * Asks shaders of light in the browser's WebGL2.
 *
 *   node dist/checks/shaders.js ASKED.json CHROMIUM
 *
 * ASKED.json has the cases of shaders-page.ts; their files lie beside it. The answers go to stdout, by case.
 */
import { readFileSync } from "node:fs";
import path from "node:path";
import { withPage } from "./browser.js";
import type { AskedCase } from "./shaders-page.js";

const [asked, executable] = process.argv.slice(2);
if (!asked || !executable) throw new Error("usage: shaders.js ASKED.json CHROMIUM");

const cases = JSON.parse(readFileSync(asked, "utf8")) as AskedCase[];
const names = cases.flatMap(({ textures, uniforms, questions }) => [
  questions,
  ...[...textures, ...uniforms].map(({ file }) => file),
]);
const files = Object.fromEntries(
  names.map((name) => [`/asked/${name}`, path.join(path.dirname(asked), name)]),
);
const there = <T extends { file: string }>(bound: T): T => ({ ...bound, file: `/asked/${bound.file}` });
const served = cases.map((each) => ({
  ...each,
  textures: each.textures.map(there),
  uniforms: each.uniforms.map(there),
  questions: `/asked/${each.questions}`,
}));
const answers = await withPage(executable, "/checks/shaders.html", files, async (page) => {
  await page.waitForFunction("window.ask");
  return page.evaluate((all) => window.ask(all), served);
});
process.stdout.write(JSON.stringify(Object.fromEntries(cases.map(({ name }, i) => [name, answers[i]]))));
