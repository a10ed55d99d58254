/**
 * Drives the viewer through what one of viewer/tours.ts asks for.
 *
 *   node dist/checks/viewer.js TOUR CHROMIUM PATH=FILE…
 *
 * The files are served under their paths. What the tour found goes to stdout as JSON, with `complaints`: all that
 * the page said on the console.
 */
import { withPage } from "./browser.js";
import { Driver } from "./viewer/driver.js";
import { TOURS } from "./viewer/tours.js";

const [name = "", executable, ...files] = process.argv.slice(2);
const tour = TOURS[name];
if (!tour || !executable) throw new Error("usage: viewer.js TOUR CHROMIUM PATH=FILE…");
const served = Object.fromEntries(files.map((pair) => pair.split("=") as [string, string]));
const found = await withPage(executable, "/built/index.html", served, async (page) => {
  const origin = new URL(page.url()).origin;
  await page.setViewportSize({ width: 256, height: 188 });
  const driver = new Driver(page, `${origin}/built/index.html`);
  return { ...(await tour(driver)), complaints: driver.complaints };
});
process.stdout.write(JSON.stringify(found));
