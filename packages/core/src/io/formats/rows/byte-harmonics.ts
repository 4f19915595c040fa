import { type ByteLayout, valueOfByte } from '../../../data/packing/row-layout.ts';
import { ROW_SLOT } from '../../../data/splats/splat-row.ts';
import type { RowSource } from './arriving-rows.ts';

/**
 * Harmonics that are bytes of a file. Sinks take the bytes, a quarter of float32. Other attributes
 * are decoded on the CPU: many need float64, and float32 results would differ between GPUs.
 */
export interface ByteHarmonics extends ByteLayout {
  /** Location of the next row. */
  readonly source: RowSource;
  /** Byte offset in a row of each coefficient, in the order of `SplatSet`. */
  readonly offsets: readonly number[];
  /** Writes all but the harmonics of the next rows, whose starts are `length` words apart. */
  decodeGeometry(rows: Float32Array, rowCount: number, length: number): void;
}

/** Whether rows of bytes are shorter than float32 coefficients; they may hold other values, too. */
export function isShorter({ strideBytes, offsets }: ByteHarmonics): boolean {
  return strideBytes < 4 * offsets.length;
}

/** Copies the bytes of the next rows to the beginning of `to`. */
export function copyRows({ source, strideBytes }: ByteHarmonics, to: Uint8Array, rowCount: number): void {
  const { bytes, start } = source;
  source.start += rowCount * strideBytes;
  to.set(bytes.subarray(start, source.start));
}

/** `DecodedRows.decode`: float32 harmonics of the same rows. */
export function floatRows(harmonics: ByteHarmonics): (rows: Float32Array, rowCount: number) => void {
  const { source, strideBytes, values } = harmonics;
  const offsets = Int32Array.from(harmonics.offsets);
  const table = Float32Array.from({ length: 256 }, (_, byte) => valueOfByte(values, byte));
  const length = ROW_SLOT.harmonics + offsets.length;
  return (rows, rowCount) => {
    harmonics.decodeGeometry(rows, rowCount, length);
    const { bytes } = source;
    for (let at = 0; at < rowCount * length; at += length, source.start += strideBytes) {
      const { start } = source;
      const shAt = at + ROW_SLOT.harmonics;
      // Red, green and blue in one iteration take two thirds of the time; this loop dominates decoding.
      for (let i = 0; i < offsets.length; i += 3) {
        rows[shAt + i] = table[bytes[start + offsets[i]]];
        rows[shAt + i + 1] = table[bytes[start + offsets[i + 1]]];
        rows[shAt + i + 2] = table[bytes[start + offsets[i + 2]]];
      }
    }
  };
}
