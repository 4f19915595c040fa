import { SplatFileError } from '../../../data/errors.ts';
import type { SplatInput } from '../read-format.ts';

/** Location of a file's next row. */
export interface RowSource {
  bytes: Uint8Array;
  /** Index in `bytes`; row decoders advance it. */
  start: number;
}

/**
 * Rows that are decoded while the rest of the file arrives. `arrive` waits for rows; then as many
 * can be decoded.
 */
export class ArrivingRows implements RowSource {
  bytes: Uint8Array = new Uint8Array(0);
  start = 0;
  readonly #input: SplatInput;
  readonly #strideBytes: number;
  readonly #placeOf: (byte: number) => string;
  #givenBytes = 0;

  /**
   * @param input positioned at the first row when `arrive` is first called.
   * @param placeOf describes the end of a truncated file, for messages.
   */
  constructor(input: SplatInput, strideBytes: number, placeOf: (byte: number) => string) {
    this.#input = input;
    this.#strideBytes = strideBytes;
    this.#placeOf = placeOf;
  }

  /** See `DecodedRows`. Rejects with SplatFileError 'truncated'. */
  readonly arrive = async (rowCount: number): Promise<void> => {
    const { name, reader } = this.#input;
    // The rows of the previous call are decoded by now.
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
