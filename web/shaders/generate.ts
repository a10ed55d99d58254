/**
 * Writes `shaders/{glsl,hlsl,msl}/` and the runtime's `pieces.ts` from `shaders/wgsl/`.
 *
 *     npm run shaders              writes
 *     npm run shaders -- --check   compares, and exits with 1 where something is stale
 */
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, relative } from "node:path";
import { fileURLToPath } from "node:url";
import {
  alternatives,
  type Choices,
  openChoices,
  type Piece,
  type Pieces,
  readPieces,
  stripped,
} from "./pieces.js";
import { isIn, LANGUAGES, type Language, type Translated, translatePiece } from "./translate.js";

const ROOT = join(dirname(fileURLToPath(import.meta.url)), "../../..");
const SHADERS = join(ROOT, "shaders");
const MODULE = join(ROOT, "web/packages/runtime/src/shaders/pieces.ts");

/** All generated files by their paths. */
function generated(pieces: Pieces): Map<string, string> {
  const files = new Map<string, string>();
  const glsl = new Map<string, string>();
  for (const language of Object.keys(LANGUAGES) as Language[]) {
    const helpers = new Set<string>();
    for (const piece of pieces.values()) {
      if (!isIn(language, pieces, piece)) continue;
      const translated = inEveryChoice(pieces, piece, language);
      for (const helper of translated.helpers) helpers.add(helper);
      if (language === "glsl") glsl.set(piece.name, translated.text);
      files.set(
        pathOf(language, piece.name),
        header(`shaders/wgsl/${piece.name}.wgsl`) + needsLine(piece) + translated.text,
      );
    }
    if (!helpers.size) continue;
    if (language === "glsl")
      throw new Error(`GLSL pieces are bundled without helpers:\n${[...helpers].join("\n")}`);
    const sorted = [...helpers].sort();
    files.set(
      pathOf(language, "helpers"),
      `${header("shaders/wgsl/")}// Comes before all pieces.\n\n${sorted.join("\n")}`,
    );
  }
  files.set(MODULE, runtimeModule(pieces, glsl));
  return files;
}

/** A piece's text, which mustn't depend on what is chosen of those that it needs. */
function inEveryChoice(pieces: Pieces, piece: Piece, language: Language): Translated {
  const first = translatePiece(pieces, piece, language, {});
  for (const choice of openChoices(pieces, piece)) {
    for (const { name } of alternatives(pieces, choice)) {
      const choices: Choices = { [choice]: name };
      if (!isIn(language, pieces, piece, choices)) continue;
      const { text } = translatePiece(pieces, piece, language, choices);
      if (text !== first.text)
        throw new Error(
          `${piece.name} in ${language} isn't the same with ${name}:\n${first.text}\n---\n${text}`,
        );
    }
  }
  return first;
}

function pathOf(language: Language, name: string): string {
  return join(SHADERS, language, `${name}.${LANGUAGES[language]}`);
}

function header(source: string): string {
  return `// Generated from ${source} by \`npm run shaders\` in web/: don't edit.\n`;
}

function needsLine({ needs, given }: Piece): string {
  const lines = [
    ...(needs.length ? [`// needs: ${needs.join(", ")}`] : []),
    ...given.map((line) => `// given, in WGSL: ${line}`),
  ];
  return `${lines.join("\n")}${lines.length ? "\n" : ""}\n`;
}

/** The texts that the runtime bundles, without comments. */
function runtimeModule(pieces: Pieces, glsl: ReadonlyMap<string, string>): string {
  const entries = [...pieces.values()].map(({ name, needs, wgsl }) => {
    const translated = glsl.get(name);
    const texts = [
      `wgsl: ${JSON.stringify(stripped(wgsl))}`,
      ...(translated === undefined ? [] : [`glsl: ${JSON.stringify(stripped(translated))}`]),
    ];
    return `  ${JSON.stringify(name)}: {\n    needs: ${JSON.stringify(needs)},\n    ${texts.join(",\n    ")},\n  },\n`;
  });
  return `// Generated from shaders/wgsl/ by \`npm run shaders\` in web/: don't edit.
import type { ShaderPiece } from "./compose.js";

/** The pieces that shaders are composed of, without comments; shaders/README.md says how they fit. */
export const PIECES: Readonly<Record<string, ShaderPiece>> = {
${entries.join("")}};
`;
}

/** Generated files that are there but have no source any more. */
function orphans(files: ReadonlyMap<string, string>): string[] {
  return Object.keys(LANGUAGES).flatMap((language) => {
    const folder = join(SHADERS, language);
    const there = existsSync(folder) ? readdirSync(folder).map((file) => join(folder, file)) : [];
    return there.filter((path) => !files.has(path));
  });
}

function main(): void {
  const files = generated(readPieces(join(SHADERS, "wgsl")));
  const stale = [...files].filter(([path, text]) => !existsSync(path) || readFileSync(path, "utf8") !== text);
  const names = [...stale.map(([path]) => path), ...orphans(files)].map((path) => relative(ROOT, path));
  if (process.argv.includes("--check")) {
    for (const name of names) console.error(`stale: ${name}`);
    console.log(JSON.stringify({ files: files.size, stale: names }));
    process.exitCode = names.length ? 1 : 0;
    return;
  }
  for (const path of orphans(files)) rmSync(path);
  for (const [path, text] of stale) {
    mkdirSync(dirname(path), { recursive: true });
    writeFileSync(path, text);
  }
  console.log(names.length ? `wrote ${names.join(", ")}` : "all up to date");
}

main();
