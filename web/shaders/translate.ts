/** One piece in another language, by naga. */
import { translate } from "naga-wasm";
import { asMember, memberConstant, privateMembers } from "./metal.js";
import { asModule, bindingsOf } from "./module.js";
import { type Choices, enabledBy, inOrder, type Piece, type Pieces } from "./pieces.js";
import { tidy } from "./tidy.js";

/** Generated languages, by the folder and the end of the name of their files. */
export const LANGUAGES = { glsl: "glsl", hlsl: "hlsl", msl: "metal" } as const;
export type Language = keyof typeof LANGUAGES;

/** A piece's own text, and functions that naga adds for what a language lacks. */
export interface Translated {
  readonly text: string;
  readonly helpers: readonly string[];
}

/** Whether a language has all that a piece and what it needs use: GLSL ES 3.00 has no half floats. */
export function isIn(language: Language, pieces: Pieces, piece: Piece, choices: Choices = {}): boolean {
  return language !== "glsl" || !enabledBy(inOrder(pieces, piece, choices)).includes("f16");
}

/** Compiles a piece with all that it needs, and takes out what is its own. */
export function translatePiece(
  pieces: Pieces,
  piece: Piece,
  language: Language,
  choices: Choices,
): Translated {
  const all = inOrder(pieces, piece, choices);
  const whole = named(naga(asModule(all), language, enabledBy(all)), bindingsOf(all));
  const helpers: string[] = [];
  const own = language === "msl" ? [privateMembers(piece.wgsl)] : [];
  for (const chunk of topLevel(whole)) {
    const name = declaredName(chunk);
    const text = (): string => tidy(language === "msl" ? memberConstant(asMember(chunk, all)) : chunk);
    if (name.startsWith("naga_")) helpers.push(text());
    else if (piece.names.includes(name)) own.push(text());
  }
  return { text: own.filter((text) => text).join("\n"), helpers };
}

function naga(source: string, language: Language, enabled: readonly string[]): string {
  const shaderModel = enabled.includes("f16") ? "6_2" : "5_1";
  if (language === "hlsl") return translate({ from: "wgsl", to: "hlsl", source, options: { shaderModel } });
  if (language === "msl") return translate({ from: "wgsl", to: "msl", source });
  const flags = { includeUnusedItems: true };
  return translate({
    from: "wgsl",
    to: "glsl",
    source,
    options: { version: "300 es", stage: "fragment", entryPoint: "main", flags },
  });
}

/** Bindings under their names; naga keeps them in HLSL and MSL. */
function named(text: string, bindings: readonly string[]): string {
  return text.replace(/_group_0_binding_(\d+)_fs/g, (_, index) => bindings[Number(index)] ?? "");
}

/** Declarations outside of functions, each with its final newline. */
function topLevel(text: string): string[] {
  const chunks: string[] = [];
  let [chunk, depth] = ["", 0];
  for (const line of text.split("\n")) {
    if (!chunk && !line.trim()) continue;
    chunk += `${line}\n`;
    for (const sign of line) depth += "{(".includes(sign) ? 1 : "})".includes(sign) ? -1 : 0;
    if (depth === 0 && /[;}]$|^#|^\/\/|^using /.test(line)) {
      chunks.push(chunk);
      chunk = "";
    }
  }
  return chunks;
}

const TYPE = String.raw`(?:(?:static|const|constant|thread|struct|metal::)\s*)*[\w:<>]+`;
const DECLARED = new RegExp(String.raw`^(?:struct (\w+)|${TYPE} (\w+)\s*[(\[=;])`);

function declaredName(chunk: string): string {
  const [, structure, other] = DECLARED.exec(chunk) ?? [];
  return structure ?? other ?? "";
}
