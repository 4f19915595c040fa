import { fromHalfBits } from '../layout/half.ts';
import { ProjectedSplat, ProjectedSplatF32 } from '../layout/structs.ts';
import type { InspectedFrame } from './inspected-frame.ts';

/** What `project` wrote for one drawn splat. */
export interface SplatRecord {
  /** Number of the splat, counting through all chunks of the frame; see `InspectedFrame.locate`. */
  readonly splat: number;
  readonly centerPx: readonly number[];
  /** Half axis at √2 standard deviations. */
  readonly majorPx: readonly number[];
  readonly minorLengthPx: number;
  readonly depthView: number;
  /** r, g, b and opacity. */
  readonly color: readonly number[];
}

/** The records of all drawn splats, in the order of `survivors`. */
export async function readRecords(frame: InspectedFrame): Promise<SplatRecord[]> {
  const count = await frame.visibleCount();
  const survivors = await frame.words('survivors');
  const words = await frame.words('projected');
  const floats = new Float32Array(words.buffer);
  const isFloat32 = frame.accuracy.recordPrecision === 'f32';
  const { bytes, offsets } = isFloat32 ? ProjectedSplatF32 : ProjectedSplat;
  return Array.from({ length: count }, (_, i) => {
    const at = (field: keyof typeof offsets) => (i * bytes + offsets[field]) / 4;
    const vector = (field: keyof typeof offsets, length: number) =>
      Array.from(floats.subarray(at(field), at(field) + length));
    return {
      splat: survivors[i],
      centerPx: vector('centerPx', 2),
      majorPx: vector('majorPx', 2),
      minorLengthPx: floats[at('minorLengthPx')],
      depthView: floats[at('depthView')],
      color: isFloat32 ? vector('color', 4) : halves(words.subarray(at('color'), at('color') + 2)),
    };
  });
}

function halves(words: Uint32Array): number[] {
  return Array.from(words).flatMap((word) => [fromHalfBits(word & 0xffff), fromHalfBits(word >>> 16)]);
}
