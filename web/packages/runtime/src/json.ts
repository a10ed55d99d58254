/** JSON from strangers: bounded in size and depth, and read with its types checked. */
import { expect, InputError } from "./errors.js";
import { didYouMean } from "./names.js";

/** How deep objects and arrays may nest; more would exhaust the stack of whoever walks them. */
export const MAX_JSON_DEPTH = 128;

const QUOTE = 0x22;
const BACKSLASH = 0x5c;
const OPENING = new Set([0x5b, 0x7b]); // [ and {
const CLOSING = new Set([0x5d, 0x7d]);

/** Parses the text of a JSON object, in UTF-8. */
export function parseJson(text: Uint8Array, where: string): JsonView {
  expect(depthOf(text) <= MAX_JSON_DEPTH, `its JSON nests over ${MAX_JSON_DEPTH} deep`, where);
  try {
    return JsonView.of(JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(text)), where);
  } catch (error) {
    if (error instanceof InputError) throw error;
    throw new InputError(`its JSON is damaged: ${error instanceof Error ? error.message : error}`, where);
  }
}

/** Deepest nesting, by counting what stands outside strings. */
function depthOf(text: Uint8Array): number {
  let [depth, deepest, inString] = [0, 0, false];
  for (let i = 0; i < text.length; i++) {
    const code = text[i] ?? 0;
    if (inString) {
      if (code === BACKSLASH) i++;
      else if (code === QUOTE) inString = false;
    } else if (code === QUOTE) inString = true;
    else if (OPENING.has(code)) deepest = Math.max(deepest, ++depth);
    else if (CLOSING.has(code)) depth--;
  }
  return deepest;
}

/** An object within some JSON. Errors name the place, as a JSON pointer behind the file. */
export class JsonView {
  readonly pointer: string;
  readonly #values: ReadonlyMap<string, unknown>;

  private constructor(values: object, pointer: string) {
    this.#values = new Map(Object.entries(values));
    this.pointer = pointer;
  }

  /** Takes a parsed value that should be an object. */
  static of(value: unknown, pointer: string): JsonView {
    const isObject = typeof value === "object" && value !== null && !Array.isArray(value);
    expect(isObject, `expected an object, found ${shown(value)}`, pointer);
    return new JsonView(value, pointer);
  }

  get keys(): string[] {
    return [...this.#values.keys()];
  }

  has(key: string): boolean {
    return this.#values.has(key);
  }

  /** The value as it is; undefined where there is none. */
  get(key: string): unknown {
    return this.#values.get(key);
  }

  /** All values as they are. */
  plain(): Readonly<Record<string, unknown>> {
    return Object.fromEntries(this.#values);
  }

  /** The pointer of a key. */
  at(key: string): string {
    return `${this.pointer}/${key}`;
  }

  /** Refuses keys that aren't in `known`, naming the nearest. */
  allow(known: readonly string[]): void {
    for (const key of this.keys) {
      expect(known.includes(key), `unknown key '${key.slice(0, 64)}'`, this.pointer, didYouMean(key, known));
    }
  }

  object(key: string): JsonView {
    return JsonView.of(this.#required(key), this.at(key));
  }

  optional(key: string): JsonView | undefined {
    return this.has(key) ? this.object(key) : undefined;
  }

  list(key: string): readonly unknown[] {
    const value = this.#required(key);
    expect(Array.isArray(value), `expected an array, found ${shown(value)}`, this.at(key));
    return value;
  }

  /** An array of objects; empty where there is none. */
  objects(key: string): JsonView[] {
    if (!this.has(key)) return [];
    return this.list(key).map((value, index) => JsonView.of(value, `${this.at(key)}/${index}`));
  }

  /** The object at a place in an array. */
  element(key: string, index: number): JsonView {
    const items = this.list(key);
    const pointer = `${this.at(key)}/${index}`;
    expect(index < items.length, `expected an element, found an array of ${items.length}`, pointer);
    return JsonView.of(items[index], pointer);
  }

  integer(key: string, low: number, high: number, whenAbsent?: number): number {
    const value = this.has(key) ? this.get(key) : whenAbsent;
    const fits = Number.isInteger(value) && Number(value) >= low && Number(value) <= high;
    expect(fits, `expected a whole number from ${low} to ${high}, found ${shown(value)}`, this.at(key));
    return Number(value);
  }

  /** A finite number. */
  number(key: string, whenAbsent?: number): number {
    const value = this.has(key) ? this.get(key) : whenAbsent;
    const isNumber = typeof value === "number" && Number.isFinite(value);
    expect(isNumber, `expected a finite number, found ${shown(value)}`, this.at(key));
    return value;
  }

  /** Exactly `count` finite numbers. */
  numbers(key: string, count: number, whenAbsent?: readonly number[]): number[] {
    if (!this.has(key) && whenAbsent) return [...whenAbsent];
    const values = this.list(key);
    const fits = values.length === count && values.every(Number.isFinite);
    expect(fits, `expected ${count} finite numbers, found ${shown(values)}`, this.at(key));
    return values.map(Number);
  }

  boolean(key: string, whenAbsent?: boolean): boolean {
    const value = this.has(key) ? this.get(key) : whenAbsent;
    expect(typeof value === "boolean", `expected true or false, found ${shown(value)}`, this.at(key));
    return value;
  }

  string(key: string): string {
    const value = this.#required(key);
    expect(typeof value === "string", `expected a string, found ${shown(value)}`, this.at(key));
    return value;
  }

  /** One of a few strings. */
  choice<const T extends string>(key: string, choices: readonly T[], whenAbsent?: T): T {
    const value = this.has(key) ? this.get(key) : whenAbsent;
    const chosen = choices.find((choice) => choice === value);
    const expected = `expected ${choices.join(" or ")}, found ${shown(value)}`;
    expect(chosen !== undefined, expected, this.at(key), didYouMean(String(value), choices));
    return chosen;
  }

  #required(key: string): unknown {
    expect(this.has(key), `'${key}' is missing`, this.pointer);
    return this.#values.get(key);
  }
}

/** A value in a message, cut to a length that fits there. */
function shown(value: unknown): string {
  if (value === undefined) return "nothing";
  if (Array.isArray(value) && value.length > 16) return `an array of ${value.length}`;
  if (typeof value === "object" && value !== null) return Array.isArray(value) ? "an array" : "an object";
  return (JSON.stringify(value) ?? typeof value).slice(0, 64);
}
