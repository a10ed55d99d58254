/**
 * Opens an example of @irradia/three in Chromium as a page that a stranger made of it, and switches its light.
 *
 *   node dist/checks/example.js EXAMPLE.html CHROMIUM SCENE.baked.glb PICTURES
 *
 * Writes PICTURES/SOURCE.png for each source of light in its menu; these and the canvas' context go to stdout as
 * JSON. Fails where the page warns of anything.
 */
import path from "node:path";
import { withPage } from "./browser.js";

const [example, executable, scene, pictures] = process.argv.slice(2);
if (!example || !executable || !scene || !pictures) {
  throw new Error("usage: example.js EXAMPLE.html CHROMIUM SCENE.baked.glb PICTURES");
}
const files = { "/example.html": example, "/scene.baked.glb": scene };
const found = await withPage(executable, "/example.html", files, async (page) => {
  const complaints: string[] = [];
  page.on("console", (message) => {
    if (["warning", "error"].includes(message.type())) complaints.push(message.text());
  });
  await page.setViewportSize({ width: 160, height: 120 });
  await page.reload(); // it fills the window that it finds
  await page.waitForSelector("option", { state: "attached" });
  const sources = await page.locator("option").allTextContents();
  for (const source of sources) {
    await page.selectOption("select", source);
    await page.evaluate(
      () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
    );
    await page.screenshot({ path: path.join(pictures, `${source}.png`) });
  }
  const kinds = ["webgpu", "webgl2"];
  const context = await page.evaluate(
    (names) => names.find((name) => document.querySelector("canvas")?.getContext(name)),
    kinds,
  );
  if (complaints.length > 0) throw new Error(`the page complained: ${complaints.join("\n")}`);
  return { sources, context };
});
process.stdout.write(JSON.stringify(found));
