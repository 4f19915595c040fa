import { ProjectedSplat, ProjectedSplatF32 } from '../layout/structs.ts';
import type { InspectedFrame } from './inspected-frame.ts';

/** Where a NaN or an infinity stands: the first of each buffer, by its bits. Nothing where all is finite. */
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

/** "column, row, channel" of value `at` of an RGBA image. */
export function describePixel(widthPx: number, at: number): string {
  const pixel = Math.floor(at / 4);
  return `column ${pixel % widthPx}, row ${Math.floor(pixel / widthPx)}, channel ${at % 4}`;
}

/**
 * Index of the first word that is a NaN or an infinity as float32, or −1. Integers in between do no harm: none of the
 * frame's uniforms is as large as 0x7f800000.
 */
export function nonFiniteWord(words: Uint32Array): number {
  return words.findIndex((word) => (word & 0x7f800000) === 0x7f800000);
}

async function nonFiniteRecord(frame: InspectedFrame): Promise<string | null> {
  const isFloat32 = frame.accuracy.recordPrecision === 'f32';
  const { bytes, offsets } = isFloat32 ? ProjectedSplatF32 : ProjectedSplat;
  const words = await frame.words('projected');
  const count = await frame.visibleCount();
  for (let i = 0; i < count; i++) {
    const record = words.subarray((i * bytes) / 4, ((i + 1) * bytes) / 4);
    const floats = isFloat32 ? record : record.subarray(0, offsets.color / 4);
    const halves = isFloat32 ? [] : Array.from(record.subarray(offsets.color / 4));
    const at = nonFiniteWord(floats);
    if (at >= 0) return `projected: record ${i}, word ${at} is not finite`;
    const isHalfBad = (half: number) => (half & 0x7c00) === 0x7c00;
    if (halves.some((word) => isHalfBad(word) || isHalfBad(word >>> 16)))
      return `projected: record ${i}, a float16 of its colour is not finite`;
  }
  return null;
}
