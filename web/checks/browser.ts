/** Chromium with software rendering, which survives on a machine without a GPU, and the files that it asks for. */
import { createReadStream } from "node:fs";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { chromium, type Page } from "playwright-core";

const WEB = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const TYPES: Record<string, string> = {
  ".html": "text/html",
  ".css": "text/css",
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".glb": "model/gltf-binary",
};
const FLAGS = [
  "--no-sandbox",
  "--enable-unsafe-webgpu",
  "--use-angle=swiftshader",
  "--use-vulkan=swiftshader",
  "--enable-features=Vulkan",
];

/** Serves web/, and `files`: their addresses and where they lie. */
function serve(files: Record<string, string>): Promise<Server> {
  const server = createServer((request, response) => {
    const name = decodeURIComponent(new URL(request.url ?? "/", "http://localhost").pathname);
    const file = files[name] ?? path.join(WEB, name);
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

/** Opens a page of web/ and hands it to `use`; what the page says goes to stderr. */
export async function withPage<T>(
  executablePath: string,
  address: string,
  files: Record<string, string>,
  use: (page: Page) => Promise<T>,
): Promise<T> {
  const server = await serve(files);
  const browser = await chromium.launch({ executablePath, args: FLAGS });
  try {
    const page = await browser.newPage();
    page.on("pageerror", (error) => console.error(error));
    page.on("console", (message) => console.error(message.text()));
    const { port } = server.address() as AddressInfo;
    await page.goto(`http://127.0.0.1:${port}${address}`);
    return await use(page);
  } finally {
    await browser.close();
    server.close();
  }
}
