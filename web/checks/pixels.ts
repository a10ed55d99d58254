/**
 * Draws a scene in its baked light in Chromium, with what is needed to work out the same pixels elsewhere.
 *
 *   node dist/checks/pixels.js REQUESTS.json CHROMIUM PATH=FILE…
 *
 * REQUESTS.json holds a list of Requests; the files are served under their paths. The Answers go to stdout as JSON. Fails where the page warns of anything.
 */
import { readFileSync } from "node:fs";
import { withPage } from "./browser.js";
import type { Answer, Request } from "./pixels/request.js";

const [requestsFile, executable, ...files] = process.argv.slice(2);
if (!requestsFile || !executable) throw new Error("usage: pixels.js REQUESTS.json CHROMIUM PATH=FILE…");
const requests: Request[] = JSON.parse(readFileSync(requestsFile, "utf8"));
const served = Object.fromEntries(files.map((pair) => pair.split("=") as [string, string]));
const answers = await withPage(executable, "/checks/pixels.html", served, async (page) => {
  const complaints: string[] = [];
  page.on("console", (message) => {
    if (["warning", "error"].includes(message.type())) complaints.push(message.text());
  });
  await page.waitForFunction("window.pixels");
  const found: Answer[] = [];
  for (const request of requests) {
    found.push(await page.evaluate((wanted) => window.pixels(wanted), request));
  }
  if (complaints.length > 0) throw new Error(`the page complained: ${complaints.join("\n")}`);
  return found;
});
process.stdout.write(JSON.stringify(answers));
