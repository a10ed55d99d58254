/**
 * Draws a .glb in Chromium with stock three.js, without a GPU.
 *
 *   node dist/checks/draw.js SCENE.glb VIEW.json CHROMIUM
 *
 * VIEW.json holds a View; the Drawing goes to stdout as JSON.
 */
import { readFileSync } from "node:fs";
import { withPage } from "./browser.js";
import type { View } from "./view.js";

const [scene, viewFile, executable] = process.argv.slice(2);
if (!scene || !viewFile || !executable) throw new Error("usage: draw.js SCENE.glb VIEW.json CHROMIUM");
const view: View = JSON.parse(readFileSync(viewFile, "utf8"));
const drawing = await withPage(executable, "/checks/page.html", { "/scene.glb": scene }, async (page) => {
  await page.waitForFunction("window.draw");
  return await page.evaluate((wanted) => window.draw(wanted), view);
});
process.stdout.write(JSON.stringify(drawing));
