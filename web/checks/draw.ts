/**
 * Draws a .glb in Chromium with stock three.js, without a GPU.
 *
 *   node dist/checks/draw.js SCENE.glb VIEW.json CHROMIUM
 *
 * VIEW.json holds a View; the Drawing goes to stdout as JSON.
 */
import { createReadStream, readFileSync } from "node:fs";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";
import type { Drawing, View } from "./view.js";

const WEB = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const TYPES: Record<string, string> = {
  ".html": "text/html",
  ".js": "text/javascript",
  ".glb": "model/gltf-binary",
};
/** Software rendering that survives on a machine without a GPU. */
const FLAGS = [
  "--no-sandbox",
  "--enable-unsafe-webgpu",
  "--use-angle=swiftshader",
  "--use-vulkan=swiftshader",
  "--enable-features=Vulkan",
];

function serve(scene: string): Promise<Server> {
  const server = createServer((request, response) => {
    const name = decodeURIComponent(new URL(request.url ?? "/", "http://localhost").pathname);
    const file = name === "/scene.glb" ? scene : path.join(WEB, name);
    const stream = createReadStream(file);
    stream.on("open", () => {
      response.writeHead(200, { "content-type": TYPES[path.extname(file)] ?? "application/octet-stream" });
      stream.pipe(response);
    });
    stream.on("error", () => response.writeHead(404).end());
  });
  return new Promise((resolve) => {
    server.listen(0, "127.0.0.1", () => resolve(server));
  });
}

async function draw(scene: string, view: View, executablePath: string): Promise<Drawing> {
  const server = await serve(scene);
  const browser = await chromium.launch({ executablePath, args: FLAGS });
  try {
    const page = await browser.newPage();
    page.on("pageerror", (error) => console.error(error));
    page.on("console", (message) => console.error(message.text()));
    const { port } = server.address() as AddressInfo;
    await page.goto(`http://127.0.0.1:${port}/checks/page.html`);
    await page.waitForFunction("window.draw");
    return await page.evaluate((wanted) => window.draw(wanted), view);
  } finally {
    await browser.close();
    server.close();
  }
}

const [scene, view, executable] = process.argv.slice(2);
if (!scene || !view || !executable) throw new Error("usage: draw.js SCENE.glb VIEW.json CHROMIUM");
const drawing = await draw(scene, JSON.parse(readFileSync(view, "utf8")), executable);
process.stdout.write(JSON.stringify(drawing));
