/**
 * MSL as members of a structure.
 *
 * Metal has no variables outside of functions, so naga hands every texture, uniform array and private variable
 * through all calls. As members of one structure functions see them without that, and texts are the same
 * whatever else there is; that is how Metal programs are usually written.
 */
import { bindingsOf } from "./module.js";
import type { Piece } from "./pieces.js";

const SCALARS: Readonly<Record<string, string>> = { f: "float", h: "half", u: "uint", i: "int" };

/** A function's text without what is handed through, and without the structures that wrap arrays. */
export function asMember(text: string, all: readonly Piece[]): string {
  const shared = [
    ...bindingsOf(all),
    ...all.flatMap(({ wgsl }) => privateVariables(wgsl).map(([name]) => name)),
  ];
  if (!shared.length) return text;
  const names = `(?:${shared.join("|")})`;
  return text
    .replace(new RegExp(`,?\\n {4}[^\\n(){};]* ${names}(?=,?\\n)`, "g"), "")
    .replace(/^([^\n]*\()(,|(?=\n\)))/gm, "$1")
    .replace(new RegExp(`(?:, |(?<=\\())${names}(?=[,)])`, "g"), "")
    .replace(/\(, /g, "(")
    .replace(/\.inner\[/g, "[")
    .replace(/\(\n\)/g, "()");
}

/** Declarations of a piece's private variables. */
export function privateMembers(wgsl: string): string {
  return privateVariables(wgsl)
    .map(([name, type]) => {
      const [, element = type, size] = /^array<(\w+), (\d+)>$/.exec(type) ?? [];
      return `${metalType(element)} ${name}${size ? `[${size}]` : ""};\n`;
    })
    .join("");
}

/** A constant as structures may hold it. */
export function memberConstant(text: string): string {
  return text.replace(/^constant /, "static constant constexpr const ");
}

function privateVariables(wgsl: string): [name: string, type: string][] {
  const found = wgsl.matchAll(/^var<private>\s+(\w+)\s*:\s*(.*?);/gm);
  return [...found].map(([, name = "", type = ""]) => [name, type]);
}

function metalType(type: string): string {
  const [, size, scalar = ""] = /^vec(\d)([fhui])$/.exec(type) ?? [];
  if (size) return `metal::${SCALARS[scalar]}${size}`;
  const simple = ({ f32: "float", u32: "uint", i32: "int" } as Readonly<Record<string, string>>)[type];
  if (!simple) throw new Error(`no type of Metal is known for ${type}`);
  return simple;
}
