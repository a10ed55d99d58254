/**
 * Times frames of a scene in several lights, in Chromium.
 *
 *   node dist/checks/cost.js REQUESTS.json CHROMIUM PATH=FILE…
 *
 * REQUESTS.json holds a list of CostRequests; the files are served under their paths. The CostAnswers go to
 * stdout as JSON.
 */
import { readFileSync } from "node:fs";
import { withPage } from "./browser.js";
import type { CostAnswer, CostRequest } from "./cost/request.js";

const [requestsFile, executable, ...files] = process.argv.slice(2);
if (!requestsFile || !executable) throw new Error("usage: cost.js REQUESTS.json CHROMIUM PATH=FILE…");
const requests: CostRequest[] = JSON.parse(readFileSync(requestsFile, "utf8"));
const served = Object.fromEntries(files.map((pair) => pair.split("=") as [string, string]));
const answers: CostAnswer[] = [];
for (const request of requests) {
  const answer = await withPage(executable, "/checks/cost.html", served, async (page) => {
    await page.waitForFunction("window.cost");
    return await page.evaluate((wanted) => window.cost(wanted), request);
  });
  answers.push(answer);
}
process.stdout.write(JSON.stringify(answers));
