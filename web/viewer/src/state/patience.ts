/** How often something may go wrong before it isn't tried again. */
export class Patience {
  #times: number[] = [];

  /**
   * @param most times
   * @param withinMs milliseconds
   */
  constructor(
    readonly most: number,
    readonly withinMs: number,
  ) {}

  /**
   * Counts one more failure.
   *
   * @param now milliseconds by a clock that never goes back
   * @returns whether to try again
   */
  allows(now: number): boolean {
    this.#times = [...this.#times.filter((time) => now - time < this.withinMs), now];
    return this.#times.length <= this.most;
  }
}
