/** Puts texts of shaders together from the pieces of `shaders/wgsl/`, the same way in every language. */
import type { ShaderLanguage } from "./light-shader.js";
import { PIECES } from "./pieces.js";

/**
 * Languages that pieces exist in. Those of the web are bundled; tools that compose others put the texts of
 * `shaders/hlsl/` or `shaders/msl/` into `PIECES` first.
 */
export type PieceLanguage = ShaderLanguage | "hlsl" | "msl";

/** One file of `shaders/wgsl/`, as the generator leaves it for us. */
export interface ShaderPiece {
  /** Pieces that must come before; a name without a piece is a choice among `NAME-…`. */
  readonly needs: readonly string[];
  readonly wgsl: string;
  /** Absent where GLSL ES 3.00 lacks what the piece is about: half floats. */
  readonly glsl?: string;
  readonly hlsl?: string;
  readonly msl?: string;
}

/** Which piece stands for a choice: `{ width: "width-64" }`. */
export type PieceChoices = Readonly<Record<string, string>>;

/** A piece with what it stands on. */
export interface PiecePick {
  readonly piece: string;
  readonly choices?: PieceChoices;
  /** Where a field has several tables: what this one's names have behind `irradia_table`, such as `_b`. */
  readonly table?: string;
}

/** What a text consists of, in order: pieces (each once, after those that it needs), or text as it is. */
export type ShaderPart = string | PiecePick | { readonly text: string };

const TABLE = /\birradia_table/g;

/** The text of all parts: functions, constants and private variables. A string is a piece without choices. */
export function composeText(language: PieceLanguage, parts: readonly ShaderPart[]): string {
  const texts = new Map<string, string>();
  const add = (name: string, pick: PiecePick): void => {
    const piece = PIECES[pick.choices?.[name] ?? name];
    if (!piece) throw new Error(`no shader piece is called ${name}, and nothing was chosen for it`);
    for (const need of piece.needs) add(need, pick);
    const own = piece[language];
    if (own === undefined) throw new Error(`the piece ${name} has no text in ${language}`);
    const text = inTable(own, pick.table ?? "");
    texts.set(text, text);
  };
  for (const part of parts) {
    if (typeof part === "string") add(part, { piece: part });
    else if ("text" in part) texts.set(part.text, part.text);
    else add(part.piece, part);
  }
  return [...texts.values()].join("\n");
}

function inTable(text: string, table: string): string {
  return table ? text.replace(TABLE, `irradia_table${table}`) : text;
}
