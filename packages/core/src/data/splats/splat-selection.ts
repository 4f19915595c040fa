import { InvalidArgumentError } from '../errors.ts';
import { checkKind, wrongArgument } from '../given.ts';
import { isDetached, shown } from '../printable.ts';

/** Largest row that can be selected: any file that fits a device has fewer rows. */
const LAST_ROW = 2 ** 31 - 1;

let versionsGiven = 0;

/**
 * A set of selected splats, one bit per row of their file. The same selection serves every cloud of
 * that file and outlives them; a cloud ignores rows that it does not have. It takes GPU memory only
 * while it is drawn.
 *
 * @example
 * const selection = new SplatSelection();
 * const pick = await view.pick(widthPx / 2, heightPx / 2);
 * if (pick) selection.toggle([pick.row]);
 * console.log(selection.size, [...selection]);
 * const effects = [highlight({ selection, color: [1, 0.5, 0], strength: 0.8 })];
 * view.render({ camera, clouds: [{ cloud, effects }], widthPx, heightPx });
 */
export class SplatSelection {
  /** Bit `row % 32` of word `row / 32`; rows beyond the words are not selected. */
  #words = new Uint32Array();
  #count = 0;
  #version = ++versionsGiven;

  /** Number of selected rows. */
  get size(): number {
    return this.#count;
  }

  /** Changes with every change of the selection; no two selections share a version. */
  get version(): number {
    return this.#version;
  }

  has(row: number): boolean {
    return ((this.#words[Math.floor(row / 32)] >>> (row % 32)) & 1) === 1;
  }

  /** @throws InvalidArgumentError for anything that is not a row; nothing changes then. */
  add(rows: Iterable<number>): void {
    this.#set(rows, true);
  }

  /** @throws InvalidArgumentError for anything that is not a row; nothing changes then. */
  delete(rows: Iterable<number>): void {
    this.#set(rows, false);
  }

  /**
   * Selects the rows that are not selected, and deselects the others; each row once, however often it
   * is listed.
   *
   * @throws InvalidArgumentError for anything that is not a row; nothing changes then.
   */
  toggle(rows: Iterable<number>): void {
    this.#set(rows, null);
  }

  /** The selected rows, in ascending order, as they are now. */
  [Symbol.iterator](): IterableIterator<number> {
    return this.rows().values();
  }

  /**
   * Selects exactly the rows whose bits are set: bit `row % 32` of word `row / 32`; rows beyond the
   * words are not selected. For millions of rows, much faster than one by one.
   *
   * @throws InvalidArgumentError for anything but a typed array.
   */
  setWords(words: Uint32Array): void {
    checkKind('words', words, 'a typed array');
    this.#words = words.slice();
    this.#count = countOfBits(words);
    this.#version = ++versionsGiven;
  }

  clear(): void {
    if (this.#count === 0) return;
    this.#words = new Uint32Array();
    this.#count = 0;
    this.#version = ++versionsGiven;
  }

  /** @internal The selected rows, in ascending order. */
  rows(): Uint32Array {
    const rows = new Uint32Array(this.#count);
    let found = 0;
    for (const [index, word] of this.#words.entries())
      for (let rest = word; rest !== 0; rest &= rest - 1)
        rows[found++] = 32 * index + 31 - Math.clz32(rest & -rest);
    return rows;
  }

  /** @internal One bit per entry of `rows`, lowest bit first: whether that row is selected. */
  bitsOf(rows: Uint32Array): Uint32Array<ArrayBuffer> {
    const bits = new Uint32Array(Math.ceil(rows.length / 32));
    // Reads beyond an array's end take five times as long: zeros stand for rows beyond the words.
    const words = new Uint32Array(Math.max(this.#words.length, bits.length));
    words.set(this.#words);
    // Writes a word of 32 splats at a time: a scene has millions, and one frame's time to do it in.
    for (let word = 0, i = 0; word < bits.length; word++) {
      let gathered = 0;
      for (const end = Math.min(rows.length, i + 32); i < end; i++) {
        const row = rows[i];
        const at = row >>> 5;
        if (at < words.length) gathered |= ((words[at] >>> row) & 1) << i;
      }
      bits[word] = gathered;
    }
    return bits;
  }

  /** @param isSelected whether to select the rows or to remove them; null toggles them. */
  #set(rows: Iterable<number>, isSelected: boolean | null): void {
    if (typeof rows?.[Symbol.iterator] !== 'function' || isDetached(rows))
      throw wrongArgument('rows', rows, 'a list of rows');
    const checked = isSelected === null ? new Set(rows) : [...rows];
    for (const row of checked) {
      if (Number.isInteger(row) && row >= 0 && row <= LAST_ROW) continue;
      const message = `Row ${shown(row)} cannot be ${isSelected === false ? 'deselected' : 'selected'}; rows are whole numbers from 0 to ${LAST_ROW}.`;
      throw new InvalidArgumentError('rows', message);
    }
    let isChanged = false;
    for (const row of checked) {
      const wasSelected = this.has(row);
      if (wasSelected === isSelected) continue;
      this.#reserve(row);
      this.#words[Math.floor(row / 32)] ^= 1 << (row % 32);
      this.#count += wasSelected ? -1 : 1;
      isChanged = true;
    }
    if (isChanged) this.#version = ++versionsGiven;
  }

  #reserve(row: number): void {
    const needed = Math.floor(row / 32) + 1;
    if (needed <= this.#words.length) return;
    const larger = new Uint32Array(Math.max(needed, 2 * this.#words.length));
    larger.set(this.#words);
    this.#words = larger;
  }
}

/** How many bits of `words` are set. */
function countOfBits(words: Uint32Array): number {
  let count = 0;
  for (const word of words) {
    const pairs = word - ((word >>> 1) & 0x55555555);
    const nibbles = (pairs & 0x33333333) + ((pairs >>> 2) & 0x33333333);
    count += Math.imul((nibbles + (nibbles >>> 4)) & 0x0f0f0f0f, 0x01010101) >>> 24;
  }
  return count;
}
