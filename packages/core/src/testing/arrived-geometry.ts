import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { logScalesOf } from '../data/packing/chunks.ts';
import { type PackedGeometry, packGeometry } from '../data/packing/geometry.ts';
import { clampLogScale } from '../data/packing/log-scale.ts';
import type { GeometryPrecision } from '../data/packing/precision.ts';
import type { SplatColumns } from '../data/splats/splat-set.ts';

export interface ArrivedGeometry extends PackedGeometry {
  /** Rests of each splat's log scales beside their steps: 512 and parts of 1024, ten bits each. */
  readonly rests: Uint32Array;
}

/** The output of stage ingest-rows: packed geometry in the order of the file. */
export function arrivedGeometry(set: SplatColumns, precision: GeometryPrecision): ArrivedGeometry {
  const geometry = packGeometry(set, precision);
  const { words, chunks } = geometry;
  const rests = new Uint32Array(set.count);
  for (let i = 0; i < set.count && precision === 'packed'; i++) {
    const { min, step } = logScalesOf(chunks, Math.floor(i / CHUNK_SPLATS));
    const steps = [words[8 * i + 5] & 0xffff, words[8 * i + 5] >>> 16, words[8 * i + 6] & 0xffff];
    for (const [axis, whole] of steps.entries()) {
      const away = clampLogScale(set.logScales[3 * i + axis]) - (min + step * whole);
      const parts = step > 0 ? Math.round((away / step) * 1024) : 0;
      rests[i] |= Math.max(0, Math.min(1023, 512 + parts)) << (10 * axis);
    }
  }
  return { ...geometry, rests };
}
