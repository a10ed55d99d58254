/**
 * A file isn't what it should be. The message says what was expected and what was found.
 *
 * Everything that this package reads is checked once, where it comes in, and what is wrong ends as one of
 * these; any other exception is a mistake of ours.
 */
export class InputError extends Error {
  override readonly name = "InputError";
  /** What was expected and what was found, without the rest of `message`. */
  readonly finding: string;
  /** The file, or a place in it, such as a JSON pointer. */
  readonly where: string;
  /** What the user can do; may be empty. */
  readonly fix: string;

  constructor(finding: string, where: string, fix = "") {
    super(`${where}: ${finding}${fix && `\n  ${fix}`}`);
    this.finding = finding;
    this.where = where;
    this.fix = fix;
  }
}

/** Throws an InputError unless `holds`. */
export function expect(holds: boolean, finding: string, where: string, fix?: string): asserts holds {
  if (!holds) throw new InputError(finding, where, fix);
}
