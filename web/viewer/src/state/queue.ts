/** Work that must not overlap: one piece after another, in the order in which it was asked for. */

/** @param signal of an AbortController: aborted once something newer makes the rest pointless */
export type Work = (signal: AbortSignal) => Promise<void>;

export class Queue {
  readonly #onIdle: () => void;
  #last: Promise<void> = Promise.resolve();
  #nWaiting = 0;
  #era = new AbortController();

  /** @param onIdle told when the last piece is done */
  constructor(onIdle: () => void) {
    this.#onIdle = onIdle;
  }

  /** Resolves, whatever comes of it, when this piece is done or was left out. */
  add(work: Work): Promise<void> {
    const { signal } = this.#era;
    this.#nWaiting += 1;
    const done = this.#last.then(() => (signal.aborted ? undefined : work(signal))).catch(() => {});
    this.#last = done.then(() => {
      this.#nWaiting -= 1;
      if (this.#nWaiting === 0) this.#onIdle();
    });
    return this.#last;
  }

  /** Ends what is being done and leaves out what waits. */
  abandon(): void {
    this.#era.abort();
    this.#era = new AbortController();
  }
}
