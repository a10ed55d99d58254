/**
 * Takes out the temporaries that naga makes of every variable it reads.
 *
 * A copy goes where its variable keeps its value up to the copy's last use, which is judged by lines: naga
 * writes a statement a line.
 */

/** `TYPE _eN = variable;`, with a swizzle or an index that is a name. */
const COPY = /^ *(?:const )?[\w:]+ (_e\d+) = ((\w+)(?:\.[xyzw]+|\[\w+\])?);$/;
const CALL = /\birradia_\w+\(/;

/** A function without copies and the brackets that are left around whole expressions. */
export function withoutCopies(text: string): string {
  let lines = text.split("\n");
  for (let at = 0; at < lines.length; at++) {
    const [, copy, value, variable] = COPY.exec(lines[at] ?? "") ?? [];
    if (!copy || !value || !variable || !keepsItsValue(lines, at, copy, value, variable)) continue;
    const rest = lines.slice(at + 1).map((line) => line.replace(word(copy), value));
    lines = [...lines.slice(0, at), ...rest];
    at--;
  }
  return lines.map(withoutBrackets).join("\n");
}

function keepsItsValue(
  lines: readonly string[],
  at: number,
  copy: string,
  value: string,
  variable: string,
): boolean {
  const uses = lines.flatMap((line, i) => (i > at && word(copy).test(line) ? [i] : []));
  const last = uses.at(-1);
  if (last === undefined) return true;
  const end = endOfBlock(lines, at, last);
  // What stands on the last line's right is read before its left is written.
  const between = lines.slice(at + 1, end === last ? last : end + 1);
  const index = /\[(\w+)\]$/.exec(value)?.[1];
  const isWritten = [variable, ...(index ? [index] : [])].some((name) =>
    between.some((line) => assigns(line, name)),
  );
  // Functions may write to what is private to the module, but to no local variable.
  const isShared = variable.startsWith("irradia_");
  return !isWritten && !(isShared && lines.slice(at + 1, last + 1).some((line) => CALL.test(line)));
}

function assigns(line: string, name: string): boolean {
  return new RegExp(`(?<![\\w.])${name}(?:\\.\\w+|\\[[^=]*\\])* (?:[-+*]?)= `).test(line);
}

/** The line of the last use, or where the block ends that holds it and not the copy: it may be a loop. */
function endOfBlock(lines: readonly string[], at: number, last: number): number {
  let depth = 0;
  for (let i = at + 1; i < lines.length; i++) {
    for (const sign of lines[i] ?? "") depth += sign === "{" ? 1 : sign === "}" ? -1 : 0;
    if (i >= last && depth <= 0) return i;
  }
  return lines.length - 1;
}

function word(name: string): RegExp {
  return new RegExp(`\\b${name}\\b`, "g");
}

function withoutBrackets(line: string): string {
  const [, before = "", inner = "", after = ""] =
    /^(.*? = |.*\breturn |\s*(?:\} else )?if \()\((.*)\)(;|\) \{)$/.exec(line) ?? [];
  return inner && isBalanced(inner) ? before + inner + after : line;
}

function isBalanced(text: string): boolean {
  let depth = 0;
  for (const sign of text) {
    depth += sign === "(" ? 1 : sign === ")" ? -1 : 0;
    if (depth < 0) return false;
  }
  return depth === 0;
}
