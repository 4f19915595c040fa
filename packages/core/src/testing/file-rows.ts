import { type ByteValues, type RowLayout, valueOfByte } from '../data/packing/row-layout.ts';
import { ROW_SLOT } from '../data/splats/splat-row.ts';
import { coefficientsPerSplat, type SplatSet } from '../data/splats/splat-set.ts';

export interface FileRowsOptions {
  readonly isBigEndian?: boolean;
  /** Bytes before each value, which belong to something else; default 0. */
  readonly gapBytes?: number;
  /** So many successive splats share harmonics, an entry of a palette; default none. */
  readonly sharedBy?: number;
  /** Writes harmonics, each the value of a byte, as bytes; default none. */
  readonly byteValues?: ByteValues;
}

/** Writes splats as rows of a file, value by value in the order of `ROW_SLOT`. */
export function fileRows(
  set: SplatSet,
  { isBigEndian = false, gapBytes = 0, sharedBy, byteValues }: FileRowsOptions = {},
): {
  readonly bytes: Uint8Array<ArrayBuffer>;
  readonly layout: RowLayout;
  readonly palette?: Float32Array<ArrayBuffer>;
} {
  const coefficients = coefficientsPerSplat(set.harmonics.degree);
  const coefficientsOf = (row: number) =>
    set.harmonics.coefficients.subarray(row * coefficients, (row + 1) * coefficients);
  const values = ROW_SLOT.harmonics + (sharedBy ? 1 : coefficients);
  const byteOf = new Map<number, number>();
  for (let byte = 0; byteValues && byte < 256; byte++) byteOf.set(valueOfByte(byteValues, byte), byte);
  const isByte = (slot: number) => byteValues && slot >= ROW_SLOT.harmonics;
  const offsets: number[] = [];
  let floatStride = gapBytes;
  let byteStride = byteValues ? gapBytes : 0;
  for (let slot = 0; slot < values; slot++) {
    offsets.push(isByte(slot) ? byteStride : floatStride);
    if (isByte(slot)) byteStride += 1 + gapBytes;
    else floatStride += 4 + gapBytes;
  }
  const strideBytes = floatStride + byteStride;
  const bytesAt = set.count * floatStride;
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
      const offset = offsets[slot];
      if (isByte(slot)) view.setUint8(bytesAt + row * byteStride + offset, byteOf.get(value)!);
      else view.setFloat32(row * floatStride + offset, value, !isBigEndian);
    }
  }
  const { count, harmonics } = set;
  const shDegree = harmonics.degree;
  const layout = {
    ...{ count, strideBytes, pieceRows: count, offsets, isBigEndian, shDegree },
    ...(byteValues && { byteHarmonics: { strideBytes: byteStride, values: byteValues } }),
  };
  if (!sharedBy) return { bytes, layout };
  const entryCount = Math.ceil(count / sharedBy);
  const palette = new Float32Array(entryCount * coefficients);
  for (let entry = 0; entry < entryCount; entry++)
    palette.set(coefficientsOf(entry * sharedBy), entry * coefficients);
  return { bytes, layout: { ...layout, palette: { entryCount, entryValues: coefficients } }, palette };
}
