import type { InspectedFrame } from './inspected-frame.ts';
import { readRecords } from './read-records.ts';

/** Describes the first NaN or infinity of each buffer, found by its bits. Empty if none. */
export async function findNonFinite(frame: InspectedFrame): Promise<string[]> {
  const found: string[] = [];
  for (const name of ['view', 'pageUniforms'] as const) {
    const at = nonFiniteWord(await frame.words(name));
    if (at >= 0) found.push(`${name}: word ${at} is not finite`);
  }
  const record = await nonFiniteRecord(frame);
  if (record) found.push(record);
  const at = nonFiniteWord(new Uint32Array(frame.image.data.buffer));
  if (at >= 0) found.push(`image: ${describePixel(frame.image.widthPx, at)} is ${frame.image.data[at]}`);
  return found;
}

/** Names column, row and channel of value `at` of an RGBA image. */
export function describePixel(widthPx: number, at: number): string {
  const pixel = Math.floor(at / 4);
  return `column ${pixel % widthPx}, row ${Math.floor(pixel / widthPx)}, channel ${at % 4}`;
}

/**
 * Index of the first word that is a NaN or an infinity as float32, or −1. Integers among the words
 * do not matter: none of the frame's uniforms is as large as 0x7f800000.
 */
export function nonFiniteWord(words: Uint32Array): number {
  return words.findIndex((word) => (word & 0x7f800000) === 0x7f800000);
}

async function nonFiniteRecord(frame: InspectedFrame): Promise<string | null> {
  const records = await readRecords(frame);
  for (const [i, record] of records.entries()) {
    const { centerPx, majorPx, minorPx, minorLengthPx, depthView, color } = record;
    // A sum of magnitudes is finite if all are; no record's values are so large that it overflows.
    if (
      Number.isFinite(
        minorLengthPx + depthView + sumOf(centerPx) + sumOf(majorPx) + sumOf(minorPx) + sumOf(color),
      )
    )
      continue;
    const fields = { centerPx, majorPx, minorPx, minorLengthPx, depthView, color };
    const [field, value] = Object.entries(fields).find(([, each]) => ![each].flat().every(Number.isFinite))!;
    return `records: record ${i}, ${field} is ${[value].flat().join(', ')}`;
  }
  return null;
}

function sumOf(values: readonly number[]): number {
  let sum = 0;
  for (const value of values) sum += Math.abs(value);
  return sum;
}
