/** Ways to spoil a file, and what readers must do with what is left. */
import assert from "node:assert/strict";
import { InputError } from "@irradia/runtime";
import type { Random } from "./random.js";

const HOSTILE_VALUES: readonly unknown[] = [
  null,
  true,
  -1,
  0,
  0.5,
  3,
  255,
  2 ** 31,
  2 ** 32,
  2 ** 53,
  1e300,
  -1e300,
  "",
  "hash",
  "__proto__",
  [],
  [0],
  [1e18, 2],
  {},
  { type: "hash", n_levels: 32, log2_table_size: 28 },
];
const SURROUNDINGS = [0x00, 0x7f];

/** A copy with a few bytes changed, cut off, or put in. */
export function corrupted(bytes: Uint8Array, random: Random): Uint8Array {
  const copy = bytes.slice();
  switch (random.below(4)) {
    case 0:
      return copy.subarray(0, random.below(copy.length));
    case 1: {
      const at = random.below(copy.length);
      const extra = Uint8Array.from({ length: 1 + random.below(16) }, () => random.below(256));
      return new Uint8Array([...copy.subarray(0, at), ...extra, ...copy.subarray(at)]);
    }
    default:
      for (let i = random.below(4); i >= 0; i--) {
        // Headers are short and decide most, so they are met more often than their share.
        const reach = random.below(2) ? copy.length : Math.min(copy.length, 160);
        copy[random.below(reach)] = random.pick([0, 1, 0x7f, 0x80, 0xff, random.below(256)]);
      }
      return copy;
  }
}

/** A copy of some JSON with one value, anywhere in it, replaced or taken out. */
export function corruptedJson<T>(json: T, random: Random): T {
  const copy = structuredClone(json);
  const places: { holder: Record<string, unknown>; key: string }[] = [];
  const walk = (holder: unknown): void => {
    if (typeof holder !== "object" || holder === null) return;
    for (const key of Object.keys(holder)) {
      places.push({ holder: holder as Record<string, unknown>, key });
      walk((holder as Record<string, unknown>)[key]);
    }
  };
  walk(copy);
  const { holder, key } = random.pick(places);
  if (random.below(5) === 0) delete holder[key];
  else if (random.below(8) === 0) holder[`${key}x`] = holder[key];
  else holder[key] = structuredClone(random.pick(HOSTILE_VALUES));
  return copy;
}

/**
 * Reads bytes that lie amid others, twice with different ones around them. What comes out mustn't
 * depend on those, and what is thrown must be an InputError with a place and a message.
 *
 * @param read gives something that JSON can hold, made of all that was read
 * @returns whether the bytes were taken for a good file
 */
export function survives(bytes: Uint8Array, read: (bytes: Uint8Array) => unknown): boolean {
  const outcomes = SURROUNDINGS.map((around) => {
    const buffer = new Uint8Array(bytes.length + 128).fill(around);
    buffer.set(bytes, 64);
    const before = Buffer.from(buffer).toString("latin1");
    const outcome = outcomeOf(() => read(buffer.subarray(64, 64 + bytes.length)));
    assert.equal(Buffer.from(buffer).toString("latin1"), before, "reading changed the file");
    return outcome;
  });
  for (const outcome of outcomes) assert.equal(outcome, outcomes[0], "what lies beside the file was read");
  return !outcomes[0]?.startsWith("InputError");
}

function outcomeOf(read: () => unknown): string {
  try {
    return JSON.stringify(read()) ?? "undefined";
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    assert.ok(
      error.finding && error.where && error.message.length < 2000,
      `a poor message: ${error.message}`,
    );
    return `InputError ${error.message}`;
  }
}

/** Asserts that reading fails with an InputError whose message matches. */
export function refuses(read: () => unknown, pattern: RegExp): void {
  assert.throws(read, (error: unknown) => {
    assert.ok(error instanceof InputError, `not an InputError: ${error}`);
    assert.match(error.message, pattern);
    return true;
  });
}
