/**
 * Bundles the README's example of @irradia/three, and one name of each of its entries, as a page's build would.
 *
 *   node dist/checks/bundle.js README.md
 *
 * By entry, the modules that got in and the bytes of the result go to stdout as JSON.
 */
import { readFileSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const WEB = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const [readme] = process.argv.slice(2);
if (!readme) throw new Error("usage: bundle.js README.md");
const example = /```js\n([\s\S]*?)```/.exec(readFileSync(readme, "utf8"))?.[1];
if (!example) throw new Error("the README has no example");
const name = (entry: string) =>
  `import { LIGHTMAP_ATTRIBUTES as names } from "${entry}"; console.log(names);`;
const forWebgpu = example
  .replaceAll("WebGLRenderer", "WebGPURenderer")
  .replaceAll(/three";/g, 'three/webgpu";');
const entries = {
  example,
  webgpuExample: forWebgpu,
  name: name("@irradia/three"),
  webgpuName: name("@irradia/three/webgpu"),
};

async function bundled(contents: string): Promise<{ modules: string[]; nBytes: number }> {
  const { metafile, outputFiles } = await build({
    stdin: { contents, resolveDir: WEB },
    absWorkingDir: WEB,
    bundle: true,
    format: "esm",
    metafile: true,
    minify: true,
    write: false,
  });
  const outputs = Object.values(metafile.outputs).flatMap(({ inputs }) => Object.entries(inputs));
  const modules = outputs.filter(([, { bytesInOutput }]) => bytesInOutput > 0).map(([file]) => file);
  return { modules, nBytes: outputFiles.reduce((sum, { contents }) => sum + contents.length, 0) };
}

const found = await Promise.all(
  Object.entries(entries).map(async ([entry, contents]) => [entry, await bundled(contents)]),
);
process.stdout.write(JSON.stringify(Object.fromEntries(found)));
