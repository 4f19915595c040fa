/** Adds up bytes of a graphics API's objects. Objects dropped without `destroy` stay in the sum. */
export class ByteLedger {
  bytes = 0;
  peakBytes = 0;
  readonly #parts = new WeakMap<object, Map<string, number>>();

  /** Notes that `part` of `object`, say one level of a texture, now takes `bytes`. */
  set(object: object, bytes: number, part = ''): void {
    const parts = this.#parts.get(object) ?? new Map<string, number>();
    this.#parts.set(object, parts);
    this.bytes += bytes - (parts.get(part) ?? 0);
    this.peakBytes = Math.max(this.peakBytes, this.bytes);
    parts.set(part, bytes);
  }

  /** Notes that `object` is gone; does nothing for one that was never noted. */
  delete(object: object): void {
    for (const bytes of this.#parts.get(object)?.values() ?? []) this.bytes -= bytes;
    this.#parts.delete(object);
  }
}
