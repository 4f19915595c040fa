import { ALL_READERS } from '../io/formats/readers.ts';
import type { RowSink } from '../io/formats/row-sink.ts';
import { readSource } from '../io/loading/read-source.ts';
import type { ReadSplatsOptions, SplatSource } from '../io/sources/splat-source.ts';
import type { ReadHarmonics } from '../packing/harmonics.ts';
import type { RowLayout } from '../packing/row-layout.ts';
import type { SplatSet } from '../splats/splat-set.ts';

/** Rows of a file as they are handed over for the GPU. */
export interface FileRows {
  readonly layout: RowLayout;
  /** One after the other, each by `ROW_SLOT`. */
  readonly values: Float32Array;
}

/** Reads the rows of a source as they are handed over, in pieces of so many bytes; calls `onTake` with the rows of each. */
export async function rowsOf(
  source: SplatSource,
  options: ReadSplatsOptions = {},
  pieceBytes = 1 << 16,
  onTake: (rowCount: number) => void = () => {},
): Promise<FileRows> {
  const sink = new Collector(onTake);
  const files = { minRows: 0, maxRows: Number.POSITIVE_INFINITY, pieceBytes };
  const set: SplatSet<ReadHarmonics> | null = await readSource(source, options, ALL_READERS, {
    sink,
    files,
  });
  if (set !== null || sink.layout === null) throw new Error('The rows were not handed over.');
  const values = new Float32Array(sink.pieces.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const piece of sink.pieces) {
    values.set(piece, at);
    at += piece.length;
  }
  return { layout: sink.layout, values };
}

class Collector implements RowSink {
  readonly mayDetach = false;
  layout: RowLayout | null = null;
  readonly pieces: Float32Array[] = [];
  readonly #onTake: (rowCount: number) => void;

  constructor(onTake: (rowCount: number) => void) {
    this.#onTake = onTake;
  }

  async begin(layout: RowLayout): Promise<void> {
    this.layout = layout;
  }

  async memory(): Promise<Uint8Array<ArrayBuffer>> {
    const { pieceRows, strideBytes } = this.layout!;
    // Memory that was used before has anything in it.
    return new Uint8Array(pieceRows * strideBytes).fill(0x7f);
  }

  take(rowCount: number, rows: Uint8Array<ArrayBuffer>): void {
    const length = (rowCount * this.layout!.strideBytes) / 4;
    this.#onTake(rowCount);
    this.pieces.push(new Float32Array(rows.buffer, rows.byteOffset, length).slice());
  }
}
