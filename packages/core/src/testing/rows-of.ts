import { expect } from 'vitest';
import { type PackedHarmonics, readCoefficients } from '../data/packing/harmonics.ts';
import { paletteValues, type RowLayout, valueOfByte } from '../data/packing/row-layout.ts';
import { ROW_SLOT } from '../data/splats/splat-row.ts';
import type { SplatSet } from '../data/splats/splat-set.ts';
import { ALL_READERS } from '../io/formats/readers.ts';
import type { RowSink } from '../io/formats/rows/row-sink.ts';
import { readSource } from '../io/loading/read-source.ts';
import { knownSource } from '../io/sources/known-source.ts';
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
  const result = await readSource(knownSource(source, options), options, ALL_READERS, { sink, files });
  if (result !== 'passed' || sink.layout === null) throw new Error('The rows were not handed over.');
  const values = joined(sink.pieces);
  const { layout } = sink;
  return {
    layout,
    notes: sink.notes,
    values: ownValues(values, joined(sink.palettePieces), layout),
  };
}

/** Expects the splats of a set whose harmonics are float32, to the bit. */
export function expectSameSplats(
  { layout, values: rows }: Pick<FileRows, 'layout' | 'values'>,
  set: SplatSet<PackedHarmonics>,
): void {
  expect(layout.count).toBe(set.count);
  expect(layout.origin ?? set.origin).toEqual(set.origin);
  const length = rows.length / set.count;
  const column = (slot: number, width: number) =>
    rows.filter((_, i) => i % length >= slot && i % length < slot + width);
  const moved = (value: number, i: number) => (layout.origin ? value : value - set.origin[i % 3]);
  expect(column(ROW_SLOT.position, 3).map(moved)).toEqual(set.positions);
  expect(column(ROW_SLOT.logScale, 3)).toEqual(set.logScales);
  expect(column(ROW_SLOT.rotation, 4)).toEqual(set.rotations);
  expect(column(ROW_SLOT.opacity, 1)).toEqual(set.opacityLogits);
  expect(column(ROW_SLOT.colorDc, 3)).toEqual(set.colorDc);
  const coefficients = length - ROW_SLOT.harmonics;
  const own = new Float64Array(coefficients);
  const harmonics = Array.from({ length: set.count }, (_, i) => {
    readCoefficients(set.harmonics, i, own);
    return [...own];
  });
  expect([...column(ROW_SLOT.harmonics, coefficients)]).toEqual(harmonics.flat());
}

function ownValues(values: Float32Array, entries: Float32Array, layout: RowLayout): Float32Array {
  if (layout.palette) return withHarmonics(values, entries, layout);
  return values;
}

/** Rows of a piece, with float32 harmonics in place of bytes. */
function withFloats(
  { buffer, byteOffset }: Uint8Array,
  rowCount: number,
  { strideBytes, offsets, byteHarmonics }: RowLayout,
): Float32Array {
  const { strideBytes: byteStride, values } = byteHarmonics!;
  const floatStride = strideBytes - byteStride;
  const view = new DataView(buffer, byteOffset);
  return Float32Array.from({ length: rowCount * offsets.length }, (_, i) => {
    const slot = i % offsets.length;
    const row = Math.floor(i / offsets.length);
    return slot < ROW_SLOT.harmonics
      ? view.getFloat32(row * floatStride + offsets[slot], true)
      : valueOfByte(values, view.getUint8(rowCount * floatStride + row * byteStride + offsets[slot]));
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
    this.#onTake(rowCount);
    const length = (rowCount * this.layout!.strideBytes) / 4;
    this.pieces.push(
      this.layout!.byteHarmonics
        ? withFloats(rows, rowCount, this.layout!)
        : new Float32Array(rows.buffer, rows.byteOffset, length).slice(),
    );
  }
}
