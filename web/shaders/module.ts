/** Makes whole modules of pieces, such as compilers take: what is given from outside is declared. */
import { enabledBy, type Piece } from "./pieces.js";

/** Vec4s of a uniform array in modules that nobody runs. */
const STUB_VEC4S = 1024;

/** Names of textures and uniform arrays, in the order of their bindings. */
export function bindingsOf(pieces: readonly Piece[]): string[] {
  return unique(pieces.flatMap(({ given }) => given.filter((line) => line.startsWith("var")))).map(
    (line) =>
      line
        .replace(/^var(<uniform>)?\s+/, "")
        .split(":")[0]
        ?.trim() ?? "",
  );
}

/** A module with an empty fragment shader. */
export function asModule(pieces: readonly Piece[]): string {
  const given = unique(pieces.flatMap((piece) => piece.given));
  const bound = given.filter((line) => line.startsWith("var"));
  const functions = given.filter((line) => line.startsWith("fn"));
  return [
    ...enabledBy(pieces).map((extension) => `enable ${extension};`),
    ...bound.map(
      (line, i) => `@group(0) @binding(${i}) ${line.replace("array<vec4f>", `array<vec4f, ${STUB_VEC4S}>`)};`,
    ),
    ...functions.map(stub),
    ...pieces.map(({ wgsl }) => wgsl),
    "@fragment fn main() {}",
  ].join("\n");
}

function stub(declaration: string): string {
  const result = declaration.split("->")[1]?.trim();
  return `${declaration} { ${result ? `return ${result}();` : ""} }`;
}

function unique(lines: readonly string[]): string[] {
  return [...new Set(lines)];
}
