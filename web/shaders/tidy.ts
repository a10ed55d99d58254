/**
 * Makes what naga writes readable, and gives compilers the loops they unroll.
 *
 * naga turns every `for` into an endless loop with flags, and in HLSL and MSL guards it against never ending and
 * clamps every index. Our loops end and our indices fit, as each piece shows, so all of that goes.
 */
import { withoutCopies } from "./copies.js";

/** One declaration of naga's: loops back to `for`, without guards, clamps and copies, local names as they were. */
export function tidy(declaration: string): string {
  const text = withoutCopies(withShortNames(restoreLoops(withoutGuards(declaration))));
  return withoutInitialiser(text)
    .replace(/\n {4}return;(?=\n\}\n)/, "")
    .replace(/^(?:\{|.*\) \{)\n\n/m, (head) => head.slice(0, -1));
}

/** Our private variables are written before they are read, and not every compiler takes naga's lists of zeros. */
function withoutInitialiser(declaration: string): string {
  return declaration.replace(
    /^((?:static )?(?!static|const\b)\w+ irradia_\w+(?:\[\d+\])?) = [^{}]*;\n$/,
    "$1;\n",
  );
}

/** naga numbers what has one name in several functions of a module; within one function there are few such. */
function withShortNames(text: string): string {
  const taken = new Set(text.match(/\b[A-Za-z]\w*\b/g) ?? []);
  const short = new Map<string, string>();
  for (const name of taken) {
    const base = /^(?!irradia_|naga_|type_)(\w*[A-Za-z_])_\d+$/.exec(name)?.[1];
    if (!base) continue;
    let free = base;
    for (let n = 1; taken.has(free) && free !== name; n++) free = `${base}_${n}`;
    taken.add(free);
    short.set(name, free);
  }
  return text.replace(/(?<![.\w])[A-Za-z]\w*/g, (name) => short.get(name) ?? name);
}

function withoutGuards(text: string): string {
  return text
    .replace(/^ *uint2 loop_bound\w* = .*;\n/gm, "")
    .replace(/^ *if \((?:metal::)?all\(loop_bound\w* == .*\{ break; \}\n/gm, "")
    .replace(/^ *loop_bound\w* -= .*;\n/gm, "")
    .replace(/\[min\(uint\((\w+)\), \d+u\)\]/g, "[$1]");
}

/** What naga makes of `for (…; i < n; i += s) { BODY }`; backreferences hold the pieces together. */
const LOOP = new RegExp(
  [
    "^( *)bool (loop_init\\w*) = true;\\n",
    "\\1while\\(true\\) \\{\\n",
    "\\1 {4}if \\(!\\2\\) \\{\\n",
    "\\1 {8}\\w+ (_e\\d+) = (\\w+);\\n",
    "\\1 {8}\\4 = \\(?\\3 \\+ (\\w+)\\)?;\\n",
    "\\1 {4}\\}\\n",
    "\\1 {4}\\2 = false;\\n",
    "((?:\\1 {4}\\w+ _e\\d+ = \\w+;\\n)+)",
    "\\1 {4}if \\(\\(?(\\w+) < (.*?)\\)?\\) \\{\\n",
    "\\1 {4}\\} else \\{\\n",
    "\\1 {8}break;\\n",
    "\\1 {4}\\}\\n",
    "\\1 {4}\\{\\n",
    "((?:\\1 {8}.*\\n|\\n)*)",
    "\\1 {4}\\}\\n",
    "\\1\\}\\n",
  ].join(""),
  "m",
);

function restoreLoops(text: string): string {
  let found = LOOP.exec(text);
  let tidied = text;
  while (found) {
    const [whole, indent = "", , , counter = "", step = "", copies = "", left = "", right = "", body = ""] =
      found;
    const values = copiesOf(copies);
    if (values.get(left) !== counter) throw new Error(`a loop that doesn't compare its counter:\n${whole}`);
    const limit = right.replace(/_e\d+/g, (name) => values.get(name) ?? name);
    const shallower = body.replace(/^ {4}/gm, "");
    const head = `${indent}for (; ${counter} < ${limit}; ${counter} += ${step}) {\n`;
    const [before, after] = [tidied.slice(0, found.index), tidied.slice(found.index + whole.length)];
    tidied = withCounter(before, counter, `${head}${shallower}${indent}}\n`, after);
    found = LOOP.exec(tidied);
  }
  if (/loop_init/.test(tidied)) throw new Error(`a loop that isn't for (…; i < n; i += s):\n${tidied}`);
  return tidied;
}

/** Moves the counter's declaration into the loop, where it is used nowhere else in its function. */
function withCounter(before: string, counter: string, loop: string, after: string): string {
  const start = before.lastIndexOf("\n}\n") + 1;
  const inFunction = before.slice(start);
  const rest = after.slice(0, after.indexOf("\n}\n"));
  const declaration = new RegExp(`^ *(\\w+) ${counter} = (?:.*);\\n`, "m").exec(inFunction);
  const set = new RegExp(`^ *${counter} = (.*);\\n$`, "m").exec(lastLine(inFunction));
  const uses = (inFunction.match(new RegExp(`\\b${counter}\\b`, "g")) ?? []).length;
  const isElsewhere = new RegExp(`\\b${counter}\\b`).test(rest) || uses !== (set ? 2 : 1);
  if (!declaration || isElsewhere) return before + loop + after;
  const value = set?.[1] ?? declaration[0].replace(/^.*? = |;\n$/g, "");
  const shortened = (set ? inFunction.slice(0, -set[0].length) : inFunction).replace(declaration[0], "");
  return (
    before.slice(0, start) +
    shortened +
    loop.replace("for (;", `for (${declaration[1]} ${counter} = ${value};`) +
    after
  );
}

function lastLine(text: string): string {
  return text.slice(text.lastIndexOf("\n", text.length - 2) + 1);
}

function copiesOf(lines: string): Map<string, string> {
  return new Map([...lines.matchAll(/(_e\d+) = (\w+);/g)].map(([, name = "", value = ""]) => [name, value]));
}
