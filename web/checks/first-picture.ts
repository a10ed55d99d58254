/**
 * Times pages from their address to their first picture: plain three.js, and with baked light, in turns.
 *
 *   node dist/checks/first-picture.js SCENE.glb VIEW.json ROUNDS FOLDER CHROMIUM
 *
 * Each page is one bundled script, which is written to FOLDER; each round is a browser of its own. Milliseconds
 * by page go to stdout as JSON.
 */
import { readFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";
import { withPage } from "./browser.js";

const WEB = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const PAGES = ["plain", "lit"] as const;
const LEAST_MEAN = 1; // of 255

const [scene, viewFile, rounds, folder, executable] = process.argv.slice(2);
if (!scene || !viewFile || !folder || !executable) {
  throw new Error("usage: first-picture.js SCENE.glb VIEW.json ROUNDS FOLDER CHROMIUM");
}
const view = readFileSync(viewFile, "utf8");
await build({
  entryPoints: PAGES.map((name) => path.join(WEB, `checks/cost/first-${name}.ts`)),
  absWorkingDir: WEB,
  bundle: true,
  format: "esm",
  minify: true,
  outdir: path.resolve(folder),
});
const found: Record<string, number[]> = { plain: [], lit: [] };
for (let round = 0; round < Number(rounds); round++) {
  for (const name of PAGES) found[name]?.push(await timed(name));
}
process.stdout.write(JSON.stringify(found));

async function timed(name: string): Promise<number> {
  const files = {
    "/scene.glb": scene as string,
    "/first.js": path.join(folder as string, `first-${name}.js`),
  };
  return await withPage(executable as string, "/checks/blank.html", files, async (page) => {
    await page.addInitScript(`window.view = ${view};`);
    await page.goto(new URL("/checks/first-picture.html", page.url()).href);
    await page.waitForFunction("window.firstPictureMs");
    const mean = await page.evaluate(() => window.firstPictureMean ?? 0);
    if (mean < LEAST_MEAN) throw new Error(`${name}: the first picture is black`);
    return await page.evaluate(() => window.firstPictureMs ?? Number.NaN);
  });
}
