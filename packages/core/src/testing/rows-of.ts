import { expect } from 'vitest';
import { paletteValues, type RowLayout, shOfByte } from '../data/packing/row-layout.ts';
import { ROW_SLOT } from '../data/splats/splat-row.ts';
import { ALL_READERS } from '../io/formats/readers.ts';
import type { RowSink } from '../io/formats/row-sink.ts';
import { readSource } from '../io/loading/read-source.ts';
import type { ReadSplatsOptions, SplatSource } from '../io/sources/splat-source.ts';

/** Rows of a file as they are handed over for the GPU, with float32 harmonics of their own. */
export interface FileRows {
  readonly layout: RowLayout;
  /** One after the other, each by `ROW_SLOT`. */
  readonly values: Float32Array;
  readonly notes: readonly string[];
}

/** Reads a source's rows as handed over, in pieces of so many bytes; calls `onTake` for each. */
export async function rowsOf(
  source: SplatSource,
  options: ReadSplatsOptions = {},
  pieceBytes = 1 << 16,
  onTake: (rowCount: number) => void = () => {},
): Promise<FileRows> {
  const sink = new Collector(onTake);
  const files = { minRows: 0, maxRows: Number.POSITIVE_INFINITY, pieceBytes };
  const result = await readSource(source, options, ALL_READERS, { sink, files });
  if (result !== 'passed' || sink.layout === null) throw new Error('The rows were not handed over.');
  const values = joined(sink.pieces);
  const { layout } = sink;
  return {
    layout,
    notes: sink.notes,
    values: ownValues(values, joined(sink.palettePieces), layout),
  };
}

function ownValues(values: Float32Array, entries: Float32Array, layout: RowLayout): Float32Array {
  if (layout.palette) return withHarmonics(values, entries, layout);
  return layout.hasByteHarmonics ? withFloats(values, layout) : values;
}

/** Rows with float32 harmonics in place of bytes. */
function withFloats(values: Float32Array, { count, strideBytes, offsets }: RowLayout): Float32Array {
  const view = new DataView(values.buffer, values.byteOffset, values.byteLength);
  return Float32Array.from({ length: count * offsets.length }, (_, i) => {
    const slot = i % offsets.length;
    const at = Math.floor(i / offsets.length) * strideBytes + offsets[slot];
    return slot < ROW_SLOT.harmonics ? view.getFloat32(at, true) : shOfByte(view.getUint8(at));
  });
}

function joined(pieces: readonly Float32Array[]): Float32Array {
  const values = new Float32Array(pieces.reduce((sum, { length }) => sum + length, 0));
  let at = 0;
  for (const piece of pieces) {
    values.set(piece, at);
    at += piece.length;
  }
  return values;
}

/** Rows with harmonics in place of palette indices. */
function withHarmonics(
  values: Float32Array,
  entries: Float32Array,
  { count, strideBytes, palette }: RowLayout,
): Float32Array {
  const { entryCount, entryValues } = palette!;
  expect(entries.length).toBe(entryCount * entryValues);
  const length = strideBytes / 4;
  const rows = Array.from({ length: count }, (_, row) => {
    const own = values.subarray(row * length, (row + 1) * length);
    const entry = own[ROW_SLOT.harmonics];
    return [
      own.subarray(0, ROW_SLOT.harmonics),
      entries.subarray(entry * entryValues, (entry + 1) * entryValues),
    ];
  });
  return joined(rows.flat());
}

class Collector implements RowSink {
  readonly mayDetach = false;
  layout: RowLayout | null = null;
  readonly pieces: Float32Array[] = [];
  readonly palettePieces: Float32Array[] = [];
  readonly notes: string[] = [];
  #paletteValuesLeft = 0;
  readonly #onTake: (rowCount: number) => void;

  constructor(onTake: (rowCount: number) => void) {
    this.#onTake = onTake;
  }

  async begin(layout: RowLayout): Promise<void> {
    this.layout = layout;
    this.#paletteValuesLeft = paletteValues(layout);
  }

  async memory(): Promise<Uint8Array<ArrayBuffer>> {
    const { pieceRows, strideBytes } = this.layout!;
    // Garbage, as in reused memory: rows must not depend on it.
    return new Uint8Array(pieceRows * strideBytes).fill(0x7f);
  }

  note(text: string): void {
    this.notes.push(text);
  }

  take(rowCount: number, rows: Uint8Array<ArrayBuffer>): void {
    if (this.#paletteValuesLeft > 0) {
      this.#paletteValuesLeft -= rowCount;
      this.palettePieces.push(new Float32Array(rows.buffer, rows.byteOffset, rowCount).slice());
      return;
    }
    const length = (rowCount * this.layout!.strideBytes) / 4;
    this.#onTake(rowCount);
    this.pieces.push(new Float32Array(rows.buffer, rows.byteOffset, length).slice());
  }
}
