/**
 * Lets stock three.js light white surfaces from a probe grid, in Chromium.
 *
 *   node dist/checks/probe-grid.js PROBES.three.json PLACES.json CHROMIUM
 *
 * PLACES.json is a list of Place; what each place shines with goes to stdout, linear RGB, as JSON.
 */
import { readFileSync } from "node:fs";
import { withPage } from "./browser.js";

const [probes, places, executable] = process.argv.slice(2);
if (!probes || !places || !executable) {
  throw new Error("usage: probe-grid.js PROBES.three.json PLACES.json CHROMIUM");
}
const wanted = JSON.parse(readFileSync(places, "utf8"));
const files = { "/probes.three.json": probes };
const shades = await withPage(executable, "/checks/probe-grid.html", files, async (page) => {
  await page.waitForFunction("window.shade");
  return await page.evaluate((list) => window.shade(list), wanted);
});
process.stdout.write(JSON.stringify(shades));
