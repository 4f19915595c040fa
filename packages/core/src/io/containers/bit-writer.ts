/** Collects bits, from the lowest of each byte on. */
export class BitWriter {
  #bytes = new Uint8Array(1 << 12);
  #length = 0;
  /** Bits that do not fill a byte yet. */
  #window = 0;
  #windowBits = 0;

  /** @param count of the lowest bits of `value`, up to 24; the others are 0. */
  write(value: number, count: number): void {
    this.#window |= value << this.#windowBits;
    this.#windowBits += count;
    if (this.#length + 4 > this.#bytes.length) {
      const larger = new Uint8Array(2 * this.#bytes.length);
      larger.set(this.#bytes);
      this.#bytes = larger;
    }
    while (this.#windowBits >= 8) {
      this.#bytes[this.#length++] = this.#window;
      this.#window >>>= 8;
      this.#windowBits -= 8;
    }
  }

  /** All bits; zeros fill the last byte. */
  finish(): Uint8Array<ArrayBuffer> {
    const rest = this.#windowBits > 0 ? 1 : 0;
    const bytes = this.#bytes.slice(0, this.#length + rest);
    if (rest > 0) bytes[this.#length] = this.#window;
    return bytes;
  }
}
