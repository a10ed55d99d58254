/**
 * Lets a browser's WebGL decode KTX2 textures, as a shader would see them.
 *
 *   node dist/checks/sample-ktx2.js CHROMIUM TEXTURE.ktx2 ...
 *
 * Prints an array with a Sampled of each as JSON.
 */
import { withPage } from "./browser.js";
import type { Sampled } from "./texture-page.js";

const [executable, ...textures] = process.argv.slice(2);
if (!executable || textures.length === 0) throw new Error("usage: sample-ktx2.js CHROMIUM TEXTURE.ktx2 ...");
const files = Object.fromEntries(textures.map((file, index) => [`/${index}.ktx2`, file]));
const sampled = await withPage(executable, "/checks/texture.html", files, async (page) => {
  await page.waitForFunction("window.sample");
  const found: Sampled[] = [];
  for (const address of Object.keys(files)) {
    found.push(await page.evaluate((wanted) => window.sample(wanted), address));
  }
  return found;
});
process.stdout.write(JSON.stringify(sampled));
