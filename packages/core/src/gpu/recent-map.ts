/** A map of the entries used last: once it is full, a new one replaces the one used longest ago. */
export class RecentMap<Key, Value> {
  readonly #limit: number;
  /** A `Map` lists entries in the order in which they were added. */
  readonly #entries = new Map<Key, Value>();

  /** @param limit most entries. */
  constructor(limit: number) {
    this.#limit = limit;
  }

  /** Returns the value, which counts as used now. */
  get(key: Key): Value | undefined {
    const value = this.#entries.get(key);
    if (value !== undefined) this.set(key, value);
    return value;
  }

  set(key: Key, value: Value): void {
    this.#entries.delete(key);
    this.#entries.set(key, value);
    if (this.#entries.size <= this.#limit) return;
    const [oldest] = this.#entries.keys();
    this.#entries.delete(oldest);
  }

  delete(key: Key): void {
    this.#entries.delete(key);
  }
}
