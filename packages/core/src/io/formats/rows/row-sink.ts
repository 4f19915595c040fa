import type { RowLayout } from '../../../data/packing/row-layout.ts';

/** Receives the raw rows of a file in pieces, after the values of its palette, if it has one. */
export interface RowSink {
  /** Whether its memory may be transferred to another buffer while it is filled. */
  readonly mayDetach: boolean;
  /** Called first. */
  begin(layout: RowLayout): Promise<void>;
  /** Resolves with memory for the next piece: `pieceRows` rows, or all rows if fewer. */
  memory(): Promise<Uint8Array<ArrayBuffer>>;
  /**
   * Takes `rowCount` rows from the beginning of the memory, which the caller must not use
   * afterwards. All pieces but the last have whole chunks; pieces of decoded rows are full. Palette
   * values come first, in pieces of their own; all but the last are full.
   *
   * @param rows bytes in the buffer of `memory`, or in the buffer to which it was transferred.
   */
  take(rowCount: number, rows: Uint8Array<ArrayBuffer>): void;
  /** Takes a note about all rows, after the last row. It follows the notes of the layout's `fileFacts`. */
  note?(text: string): void;
}

/** Limits of the files whose rows go to a sink. Can be posted to another thread. */
export interface RowFiles {
  /**
   * Files with fewer rows are read without the sink, unless they arrive slowly. So are files with
   * more than `maxRows`.
   */
  readonly minRows: number;
  readonly maxRows: number;
  /** Most bytes per piece, but at least one chunk of rows. */
  readonly pieceBytes: number;
}

/** Whether files with this many rows go to the sink. */
export function takesCount({ minRows, maxRows }: RowFiles, count: number): boolean {
  return count >= minRows && count <= maxRows;
}

/** Result of a load whose rows have gone to a sink. */
export type Passed = 'passed';

export interface RowsTo {
  readonly sink: RowSink;
  readonly files: RowFiles;
}
