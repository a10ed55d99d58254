/**
 * Loads scenes with @irradia/three in Chromium and draws what jobs ask for.
 *
 *   node dist/checks/plugin.js JOBS.json CHROMIUM PATH=FILE…
 *
 * JOBS.json holds a list of Jobs; the files are served under their paths. The Reports go to stdout as JSON. Fails where the page warns of anything.
 */
import { readFileSync } from "node:fs";
import { withPage } from "./browser.js";
import type { Job, Report } from "./plugin/job.js";

const [jobsFile, executable, ...files] = process.argv.slice(2);
if (!jobsFile || !executable) throw new Error("usage: plugin.js JOBS.json CHROMIUM PATH=FILE…");
const jobs: Job[] = JSON.parse(readFileSync(jobsFile, "utf8"));
const served = Object.fromEntries(files.map((pair) => pair.split("=") as [string, string]));
const reports = await withPage(executable, "/checks/plugin.html", served, async (page) => {
  const complaints: string[] = [];
  page.on("console", (message) => {
    if (["warning", "error"].includes(message.type())) complaints.push(message.text());
  });
  await page.waitForFunction("window.runJob");
  const found: Report[] = [];
  for (const job of jobs) found.push(await page.evaluate((wanted) => window.runJob(wanted), job));
  if (complaints.length > 0) throw new Error(`the page complained: ${complaints.join("\n")}`);
  return found;
});
process.stdout.write(JSON.stringify(reports));
