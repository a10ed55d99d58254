/** What went wrong, in the words of the error panel. */
import { InputError } from "@irradia/runtime";

export interface Problem {
  readonly title: string;
  /** What was expected and what was found. */
  readonly finding: string;
  readonly where: string;
  readonly fix: string;
}

/** Where nobody knows better. */
const DAMAGED = "The file may be damaged: write it again, or copy it again.";

/**
 * @param error anything that was thrown
 * @param name of the file that was being opened
 */
export function problemOf(error: unknown, name: string): Problem {
  const title = `Can't open ${name}`;
  if (error instanceof InputError) {
    return { title, finding: sentence(error.finding), where: error.where, fix: error.fix || DAMAGED };
  }
  const message = error instanceof Error ? error.message : String(error);
  return { title, finding: sentence(message), where: name, fix: DAMAGED };
}

function sentence(text: string): string {
  const trimmed = text.trim();
  const first = trimmed.charAt(0).toUpperCase() + trimmed.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}
