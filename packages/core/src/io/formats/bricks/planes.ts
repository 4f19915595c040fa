/** Writes columns of integers as byte planes: one byte per row in each plane. */
export class PlaneWriter {
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly #rows: number;
  #at: number;

  /** @param headBytes bytes reserved before the planes. */
  constructor(rows: number, headBytes: number, planes: number) {
    this.bytes = new Uint8Array(headBytes + rows * planes);
    this.#rows = rows;
    this.#at = headBytes;
  }

  /** Adds a column of 8-bit values. */
  narrow(value: (row: number) => number): void {
    for (let row = 0; row < this.#rows; row++) this.bytes[this.#at + row] = value(row);
    this.#at += this.#rows;
  }

  /** Adds a column of 16-bit values: first the high bytes, which are mostly alike. */
  wide(value: (row: number) => number): void {
    const { bytes } = this;
    const [high, low] = [this.#at, this.#at + this.#rows];
    for (let row = 0; row < this.#rows; row++) {
      const bits = value(row);
      bytes[high + row] = bits >> 8;
      bytes[low + row] = bits;
    }
    this.#at += 2 * this.#rows;
  }

  /** Adds the differences between consecutive values, each below 2¹⁵ in magnitude. */
  differences(value: (row: number) => number): void {
    let before = 0;
    this.wide((row) => {
      const now = value(row);
      const bits = zigzag(now - before);
      before = now;
      return bits;
    });
  }
}

/** Reads the output of `PlaneWriter`. The caller checks that all bytes are present. */
export class PlaneReader {
  readonly #bytes: Uint8Array;
  readonly #rows: number;
  #at: number;

  constructor(bytes: Uint8Array, rows: number, headBytes: number) {
    this.#bytes = bytes;
    this.#rows = rows;
    this.#at = headBytes;
  }

  narrow(take: (row: number, value: number) => void): void {
    for (let row = 0; row < this.#rows; row++) take(row, this.#bytes[this.#at + row]);
    this.#at += this.#rows;
  }

  wide(take: (row: number, value: number) => void): void {
    const bytes = this.#bytes;
    const [high, low] = [this.#at, this.#at + this.#rows];
    for (let row = 0; row < this.#rows; row++) take(row, (bytes[high + row] << 8) | bytes[low + row]);
    this.#at += 2 * this.#rows;
  }

  differences(take: (row: number, value: number) => void): void {
    let value = 0;
    this.wide((row, bits) => {
      value += unzigzag(bits);
      take(row, value);
    });
  }
}

/** Maps a signed integer to an unsigned one, in the order 0, −1, 1, −2, 2, … */
export function zigzag(value: number): number {
  return (value << 1) ^ (value >> 31);
}

export function unzigzag(bits: number): number {
  return (bits >>> 1) ^ -(bits & 1);
}
