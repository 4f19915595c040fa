/** The last values of a row, at most `capacity` of them. */
export class Ring<Value> {
  readonly capacity: number;
  readonly #values: Value[] = [];
  /** Where the next value goes once all places are taken: that of the oldest. */
  #next = 0;

  constructor(capacity: number) {
    this.capacity = capacity;
  }

  push(value: Value): void {
    this.#values[this.#next] = value;
    this.#next = (this.#next + 1) % this.capacity;
  }

  clear(): void {
    this.#values.length = 0;
    this.#next = 0;
  }

  /** The values, oldest first. */
  toArray(): Value[] {
    const isFull = this.#values.length === this.capacity;
    return isFull
      ? [...this.#values.slice(this.#next), ...this.#values.slice(0, this.#next)]
      : [...this.#values];
  }
}
