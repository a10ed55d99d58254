/**
 * Bundles the viewer into dist/: index.html, viewer.js, viewer.css. All addresses in them are relative, so
 * the folder can lie anywhere.
 *
 *   node build.js [--out DIR] [--watch]
 */
import { cpSync, mkdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { parseArgs } from "node:util";
import { context } from "esbuild";

const here = fileURLToPath(new URL(".", import.meta.url));
const { values } = parseArgs({ options: { out: { type: "string" }, watch: { type: "boolean" } } });
const out = values.out ?? `${here}dist`;
/** Addons import "three", which is WebGLRenderer with all of its shaders; this page has no use for those. */
const oneThree = {
  name: "one three",
  setup: (build) => {
    build.onResolve({ filter: /^three$/ }, ({ kind, resolveDir }) =>
      build.resolve("three/webgpu", { kind, resolveDir }),
    );
  },
};
/** Licences that stand in `//` comments, which bundlers drop, as comments that they keep. */
const notices = {
  name: "notices",
  setup: (build) => {
    build.onLoad({ filter: /(EXRLoader|meshopt_decoder\.module)\.js$/ }, ({ path }) => {
      const text = readFileSync(path, "utf8");
      const lines = text.split("\n", 90).filter((line) => line.startsWith("//"));
      const notice = lines.map((line) => line.replace(/^[/ ]+/, "").replaceAll("*/", "")).join("\n");
      return { contents: `/*!\n${notice}\n*/\n${text}`, loader: "js" };
    });
  },
};
const bundle = await context({
  absWorkingDir: here,
  entryPoints: { viewer: "src/main.ts" },
  outdir: out,
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  plugins: [oneThree, notices],
  legalComments: "eof",
  logLevel: "warning",
});
const styles = await context({
  absWorkingDir: here,
  entryPoints: { viewer: "src/style/index.css" },
  outdir: out,
  bundle: true,
  minify: true,
  logLevel: "warning",
});
mkdirSync(out, { recursive: true });
cpSync(`${here}index.html`, `${out}/index.html`);
for (const one of [bundle, styles]) {
  await one.rebuild();
  if (values.watch) await one.watch();
  else await one.dispose();
}
