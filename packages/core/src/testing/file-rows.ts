import { type RowLayout, shOfByte } from '../data/packing/row-layout.ts';
import { ROW_SLOT } from '../data/splats/splat-row.ts';
import { coefficientsPerSplat, type SplatSet } from '../data/splats/splat-set.ts';

export interface FileRowsOptions {
  readonly isBigEndian?: boolean;
  /** Bytes before each value, which belong to something else; default 0. */
  readonly gapBytes?: number;
  /** So many successive splats share harmonics, an entry of a palette; default none. */
  readonly sharedBy?: number;
  /** Whether harmonics, each that of a byte, are written as bytes; default false. */
  readonly hasByteHarmonics?: boolean;
}

const BYTES = new Map(Array.from({ length: 256 }, (_, byte) => [shOfByte(byte), byte]));

/** Writes splats as rows of a file, value by value in the order of `ROW_SLOT`. */
export function fileRows(
  set: SplatSet,
  { isBigEndian = false, gapBytes = 0, sharedBy, hasByteHarmonics }: FileRowsOptions = {},
): {
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly layout: RowLayout;
  readonly palette?: Float32Array<ArrayBuffer>;
} {
  const coefficients = coefficientsPerSplat(set.harmonics.degree);
  const coefficientsOf = (row: number) =>
    set.harmonics.coefficients.subarray(row * coefficients, (row + 1) * coefficients);
  const values = ROW_SLOT.harmonics + (sharedBy ? 1 : coefficients);
  const isByte = (slot: number) => hasByteHarmonics && slot >= ROW_SLOT.harmonics;
  const offsets: number[] = [];
  let strideBytes = gapBytes;
  for (let slot = 0; slot < values; slot++) {
    offsets.push(strideBytes);
    strideBytes += (isByte(slot) ? 1 : 4) + gapBytes;
  }
  const bytes = new Uint8Array(set.count * strideBytes).fill(0xff);
  const view = new DataView(bytes.buffer);
  for (let row = 0; row < set.count; row++) {
    const rowValues = [
      ...set.positions.subarray(3 * row, 3 * row + 3),
      ...set.logScales.subarray(3 * row, 3 * row + 3),
      ...set.rotations.subarray(4 * row, 4 * row + 4),
      set.opacityLogits[row],
      ...set.colorDc.subarray(3 * row, 3 * row + 3),
      ...(sharedBy ? [Math.floor(row / sharedBy)] : coefficientsOf(row)),
    ];
    for (const [slot, value] of rowValues.entries()) {
      const at = row * strideBytes + offsets[slot];
      if (isByte(slot)) view.setUint8(at, BYTES.get(value)!);
      else view.setFloat32(at, value, !isBigEndian);
    }
  }
  const { count, harmonics } = set;
  const shDegree = harmonics.degree;
  const layout = { count, strideBytes, pieceRows: count, offsets, isBigEndian, shDegree, hasByteHarmonics };
  if (!sharedBy) return { bytes, layout };
  const entryCount = Math.ceil(count / sharedBy);
  const palette = new Float32Array(entryCount * coefficients);
  for (let entry = 0; entry < entryCount; entry++)
    palette.set(coefficientsOf(entry * sharedBy), entry * coefficients);
  return { bytes, layout: { ...layout, palette: { entryCount, entryValues: coefficients } }, palette };
}
