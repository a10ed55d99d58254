/** What went wrong, in the words of the error panel. */
import { InputError } from "@irradia/runtime";

export interface Problem {
  readonly title: string;
  /** What was expected and what was found. */
  readonly finding: string;
  readonly where: string;
  readonly fix: string;
}

/**
 * @param error anything that was thrown
 * @param name of the file that was being opened
 */
export function problemOf(error: unknown, name: string): Problem {
  const title = `Can't open ${name}`;
  if (error instanceof InputError) {
    return { title, finding: sentence(error.finding), where: error.where, fix: error.fix };
  }
  const message = error instanceof Error ? error.message : String(error);
  return { title, finding: sentence(message), where: name, fix: "Is the file whole? Try to write it again." };
}

function sentence(text: string): string {
  const trimmed = text.trim();
  const first = trimmed.charAt(0).toUpperCase() + trimmed.slice(1);
  return /[.!?]$/.test(first) ? first : `${first}.`;
}
