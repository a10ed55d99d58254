import assert from "node:assert/strict";
import { test } from "node:test";
import { withoutCopies } from "./copies.js";
import { tidy } from "./tidy.js";

/** A function of these lines, as naga lays it out. */
const body = (...lines: readonly string[]): string =>
  ["void f() {", ...lines.map((line) => `    ${line}`), "}", ""].join("\n");

const LOOP = body(
  "uint i = 0u;",
  "uint2 loop_bound = uint2(4294967295u, 4294967295u);",
  "bool loop_init = true;",
  "while(true) {",
  "    if (all(loop_bound == uint2(0u, 0u))) { break; }",
  "    loop_bound -= uint2(loop_bound.y == 0u, 1u);",
  "    if (!loop_init) {",
  "        uint _e9 = i;",
  "        i = (_e9 + 1u);",
  "    }",
  "    loop_init = false;",
  "    uint _e2 = i;",
  "    if ((_e2 < n)) {",
  "    } else {",
  "        break;",
  "    }",
  "    {",
  "        uint _e5 = i;",
  "        irradia_list[min(uint(_e5), 15u)] = 0.0;",
  "    }",
  "}",
  "return;",
);

test("naga's loops are for loops again", () => {
  const expected = body("for (uint i = 0u; i < n; i += 1u) {", "    irradia_list[i] = 0.0;", "}");
  assert.equal(tidy(LOOP), expected);
});

test("a counter that is used after its loop stays outside of it", () => {
  const tidied = tidy(LOOP.replace("    return;", "    irradia_g(i);"));
  assert.match(tidied, /uint i = 0u;\n {4}for \(; i < n; i \+= 1u\)/);
});

test("a loop of another form is refused", () => {
  assert.throws(() => tidy(LOOP.replace("_e2 < n", "_e2 != n")), /a loop that isn't/);
});

test("a copy goes where its variable keeps its value", () => {
  const text = body("uint _e1 = a;", "uint b = (_e1 + 1u);");
  assert.equal(withoutCopies(text), body("uint b = a + 1u;"));
  const own = body("uint _e1 = a;", "a = (_e1 + 1u);");
  assert.equal(withoutCopies(own), body("a = a + 1u;"));
});

test("a copy stays where its variable changes before the copy's last use", () => {
  for (const change of ["a = 2u;", "a[3] = 2u;", "a[(i + 1u)].x = 2u;", "a.x = 2u;", "if (b) { a = 2u; }"]) {
    const text = body("uint _e1 = a;", change, "uint c = _e1;");
    assert.equal(withoutCopies(text), text);
  }
});

test("a copy stays where the index that it was read at changes", () => {
  const text = body("uint _e1 = list[i];", "i = 2u;", "uint c = _e1;");
  assert.equal(withoutCopies(text), text);
});

test("a copy stays where a loop changes its variable after using the copy", () => {
  const text = body("uint _e1 = a;", "for (; i < n; i += 1u) {", "    uint c = _e1;", "    a = 2u;", "}");
  assert.equal(withoutCopies(text), text);
});

test("a copy of what is private to the module stays where a function may change it", () => {
  const text = body("vec4 _e1 = irradia_units[i];", "vec4 _e2 = irradia_g(i);", "vec4 c = (_e1);");
  assert.match(withoutCopies(text), /vec4 _e1 = irradia_units\[i\];/);
  const local = text.replace(/irradia_units/g, "units");
  assert.doesNotMatch(withoutCopies(local), /_e1/);
});

test("brackets go only where they are around everything", () => {
  const text = body("uint a = (b + c) * (d + e);", "uint f = (b + c);");
  assert.equal(withoutCopies(text), body("uint a = (b + c) * (d + e);", "uint f = b + c;"));
});
