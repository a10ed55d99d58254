/** One value that changes, and those who want to know. */

/** Is told which keys changed, by the new and the old value. */
export type Listener<T> = (now: T, before: T) => void;

export class Store<T extends object> {
  #value: T;
  readonly #listeners = new Set<Listener<T>>();

  constructor(initial: T) {
    this.#value = initial;
  }

  get value(): T {
    return this.#value;
  }

  /** Replaces the named keys; nobody hears of it where all of them stay as they are. */
  set(patch: Partial<T>): void {
    const before = this.#value;
    const isSame = Object.entries(patch).every(([key, value]) => Object.is(before[key as keyof T], value));
    if (isSame) return;
    this.#value = { ...before, ...patch };
    for (const listener of this.#listeners) listener(this.#value, before);
  }

  /** @returns a function that ends it */
  subscribe(listener: Listener<T>): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  /** Calls `react` now, and whenever what `select` gives has changed. */
  watch<V>(select: (value: T) => V, react: (selected: V) => void): () => void {
    let last = select(this.#value);
    react(last);
    return this.subscribe((now) => {
      const next = select(now);
      if (Object.is(next, last)) return;
      last = next;
      react(next);
    });
  }
}
