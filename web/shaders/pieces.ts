/** The pieces of `shaders/wgsl/`: what their comments declare, and in which order they go together. */
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";

/** One file. */
export interface Piece {
  readonly name: string;
  /** Pieces that must come before; a name without a file is a choice among `NAME-…`. */
  readonly needs: readonly string[];
  /** What whoever uses the piece provides: `var texture: type`, `var<uniform> …` or `fn name(…)`. */
  readonly given: readonly string[];
  /** WGSL's extensions that it uses, such as `f16`. */
  readonly enables: readonly string[];
  readonly wgsl: string;
  /** Of its functions, constants, structures and private variables. */
  readonly names: readonly string[];
}

export type Pieces = ReadonlyMap<string, Piece>;

/** Which file stands for a choice. */
export type Choices = Readonly<Record<string, string>>;

const DECLARATION = /^(?:fn|const|struct|var<private>)\s+(\w+)/gm;

/** Reads all pieces of a folder. */
export function readPieces(folder: string): Pieces {
  const files = readdirSync(folder).filter((file) => file.endsWith(".wgsl"));
  return new Map(
    files.sort().map((file) => {
      const name = file.replace(/\.wgsl$/, "");
      return [name, readPiece(name, readFileSync(join(folder, file), "utf8"))];
    }),
  );
}

/** A piece from its text. */
export function readPiece(name: string, wgsl: string): Piece {
  const said = (key: string): string[] =>
    [...wgsl.matchAll(new RegExp(`^// ${key}: (.*)$`, "gm"))].map(([, value = ""]) => value.trim());
  const list = (key: string): string[] => said(key).flatMap((value) => value.split(/\s*,\s*/));
  const names = [...wgsl.matchAll(DECLARATION)].map(([, declared = ""]) => declared);
  for (const declared of names) {
    if (!/^irradia_/.test(declared)) throw new Error(`${name}: ${declared} doesn't begin with irradia_`);
  }
  return { name, needs: list("needs"), given: said("given"), enables: list("enable"), wgsl, names };
}

/** Files among which a need chooses; one where it is a file's own name. */
export function alternatives(pieces: Pieces, need: string): readonly Piece[] {
  const exact = pieces.get(need);
  if (exact) return [exact];
  const found = [...pieces.values()].filter(({ name }) => name.startsWith(`${need}-`));
  if (!found.length) throw new Error(`no piece is called ${need} or ${need}-…`);
  return found;
}

/** A piece and all that it needs, each after what it needs itself. */
export function inOrder(pieces: Pieces, piece: Piece, choices: Choices = {}): Piece[] {
  const ordered = new Set<Piece>();
  const visit = (each: Piece): void => {
    for (const need of each.needs) visit(chosen(pieces, need, choices));
    ordered.add(each);
  };
  visit(piece);
  return [...ordered];
}

/** Extensions of WGSL that pieces use. */
export function enabledBy(pieces: readonly Piece[]): string[] {
  return [...new Set(pieces.flatMap(({ enables }) => enables))];
}

/** Choices that a piece depends on, directly or not. */
export function openChoices(pieces: Pieces, piece: Piece): string[] {
  const needs = inOrder(pieces, piece).flatMap((each) => each.needs);
  return [...new Set(needs)].filter((need) => !pieces.has(need));
}

function chosen(pieces: Pieces, need: string, choices: Choices): Piece {
  const found = pieces.get(choices[need] ?? need) ?? alternatives(pieces, need)[0];
  if (!found) throw new Error(`no piece is called ${need}`);
  return found;
}

/** Text without comments, blank lines and indentation. */
export function stripped(text: string): string {
  const lines = text.split("\n").map((line) => line.replace(/\/\/.*$/, "").trim());
  return lines.filter((line) => line).join("\n");
}
