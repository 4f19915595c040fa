/** Time after its last use for which a result is kept, ms. */
const KEPT_MS = 2000;
/** Most results, so that small ones of ended scenes do not accumulate. */
const MOST_RESULTS = 4;

interface Result<Value> {
  readonly value: Promise<Value>;
  /** 0 until known. */
  bytes: number;
}

/**
 * The last results of an expensive function, for callers that come back to them soon. They are
 * dropped once nobody has asked for two seconds.
 */
export class LastResults<Value> {
  readonly #keptBytes: number;
  readonly #bytesOf: (value: Value) => number;
  /** By key, the last used one last. */
  readonly #results = new Map<number, Result<Value>>();
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** @param keptBytes limit of all results together; the last one is kept if it is larger. */
  constructor(keptBytes: number, bytesOf: (value: Value) => number) {
    this.#keptBytes = keptBytes;
    this.#bytesOf = bytesOf;
  }

  /** The result of a key, made if it is not there. Rejects as `make`. */
  async get(key: number, make: () => Promise<Value>): Promise<Value> {
    clearTimeout(this.#timer);
    const known = this.#results.get(key);
    const result = known ?? this.#begin(key, make);
    try {
      const value = await result.value;
      result.bytes = this.#bytesOf(value);
      this.#results.delete(key);
      this.#results.set(key, result);
      this.#dropOthers(key);
      return value;
    } catch (error) {
      // The call that made it may have been aborted.
      if (known) return this.get(key, make);
      throw error;
    } finally {
      this.#dropLater();
    }
  }

  #begin(key: number, make: () => Promise<Value>): Result<Value> {
    const result = { value: make(), bytes: 0 };
    this.#results.set(key, result);
    // Callers get the error; a later call tries again.
    result.value.catch(() => {
      if (this.#results.get(key) === result) this.#results.delete(key);
    });
    return result;
  }

  #dropOthers(key: number): void {
    let bytes = [...this.#results.values()].reduce((sum, result) => sum + result.bytes, 0);
    for (const [other, result] of this.#results) {
      if (bytes <= this.#keptBytes && this.#results.size <= MOST_RESULTS) return;
      if (other === key || result.bytes === 0) continue;
      this.#results.delete(other);
      bytes -= result.bytes;
    }
  }

  #dropLater(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#results.clear(), KEPT_MS);
    // Node must not wait for it.
    (this.#timer as { unref?: () => void }).unref?.();
  }
}
