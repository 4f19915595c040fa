import { SplatFileError } from '../../data/errors.ts';
import type { SplatInput } from './read-format.ts';

/** Where the next row of a file is. */
export interface RowSource {
  bytes: Uint8Array;
  /** Index in `bytes`; decoders of rows move it on. */
  start: number;
}

/** Rows that are decoded while the rest arrives: first `arrive`, then as many can be decoded. */
export class ArrivingRows implements RowSource {
  bytes: Uint8Array = new Uint8Array(0);
  start = 0;
  readonly #input: SplatInput;
  readonly #strideBytes: number;
  readonly #placeOf: (byte: number) => string;
  #givenBytes = 0;

  /**
   * @param input at the first row when `arrive` is first called.
   * @param placeOf for a message: where a file ends that has no more than so many bytes.
   */
  constructor(input: SplatInput, strideBytes: number, placeOf: (byte: number) => string) {
    this.#input = input;
    this.#strideBytes = strideBytes;
    this.#placeOf = placeOf;
  }

  /** See `DecodedRows`. Rejects with SplatFileError 'truncated'. */
  readonly arrive = async (rowCount: number): Promise<void> => {
    const { name, reader } = this.#input;
    // The rows that it waited for before are decoded.
    reader.advance(this.#givenBytes);
    this.#givenBytes = rowCount * this.#strideBytes;
    if (!(await reader.fill(this.#givenBytes))) {
      const byte = reader.byteOffset + reader.available;
      const message = `it ends ${this.#placeOf(byte)}. Download or export it again.`;
      throw new SplatFileError('truncated', name, message, { byte });
    }
    this.bytes = reader.bytes;
    this.start = reader.start;
  };
}
