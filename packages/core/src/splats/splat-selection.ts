import { InvalidArgumentError } from '../errors.ts';

/** Rows are told apart up to here: those of any file that fits a device. */
const LAST_ROW = 2 ** 31 - 1;

let versionsGiven = 0;

/**
 * Splats that were chosen, by their rows in the file: a bit each. The same selection does for every cloud of that file, and
 * outlives it; rows that a cloud does not have are not drawn there. Nothing of it is on the GPU but while it is drawn.
 */
export class SplatSelection {
  /** Bit `row % 32` of word `row / 32`; rows beyond are not selected. */
  #words = new Uint32Array();
  #count = 0;
  #version = ++versionsGiven;

  /** How many rows are selected. */
  get count(): number {
    return this.#count;
  }

  /** Another number after every change, which no other selection has. */
  get version(): number {
    return this.#version;
  }

  has(row: number): boolean {
    return ((this.#words[Math.floor(row / 32)] >>> (row % 32)) & 1) === 1;
  }

  /** @throws InvalidArgumentError for what is no row; the selection stays as it was then. */
  add(rows: Iterable<number>): void {
    this.#set(rows, true);
  }

  /** @throws InvalidArgumentError for what is no row; the selection stays as it was then. */
  delete(rows: Iterable<number>): void {
    this.#set(rows, false);
  }

  clear(): void {
    if (this.#count === 0) return;
    this.#words = new Uint32Array();
    this.#count = 0;
    this.#version = ++versionsGiven;
  }

  /** @internal A bit per entry of `rows`, the first one lowest: whether that row is selected. */
  bitsOf(rows: Uint32Array): Uint32Array<ArrayBuffer> {
    const bits = new Uint32Array(Math.ceil(rows.length / 32));
    for (let i = 0; i < rows.length; i++) if (this.has(rows[i])) bits[Math.floor(i / 32)] |= 1 << (i % 32);
    return bits;
  }

  #set(rows: Iterable<number>, isSelected: boolean): void {
    const checked = [...rows];
    for (const row of checked) {
      if (Number.isInteger(row) && row >= 0 && row <= LAST_ROW) continue;
      const message = `Row ${row} is to be ${isSelected ? 'selected' : 'let go'}; rows are whole numbers from 0.`;
      throw new InvalidArgumentError('rows', message);
    }
    const before = this.#count;
    for (const row of checked) {
      if (this.has(row) === isSelected) continue;
      this.#reserve(row);
      this.#words[Math.floor(row / 32)] ^= 1 << (row % 32);
      this.#count += isSelected ? 1 : -1;
    }
    if (this.#count !== before) this.#version = ++versionsGiven;
  }

  #reserve(row: number): void {
    const needed = Math.floor(row / 32) + 1;
    if (needed <= this.#words.length) return;
    const larger = new Uint32Array(Math.max(needed, 2 * this.#words.length));
    larger.set(this.#words);
    this.#words = larger;
  }
}
