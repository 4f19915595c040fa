import { CHUNK_WORDS } from '../layout/chunk-words.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import type { SplatColumns } from '../splats/splat-set.ts';
import { emptyBounds, widenBounds } from './center-bounds.ts';
import { clampLogScale, type LogScaleRange, logScaleRange } from './log-scale.ts';

const { minPosition, minLogScale, maxPosition, logScaleStep, count: WORDS } = CHUNK_WORDS;

export function chunkCountOf(splatCount: number): number {
  return Math.ceil(splatCount / CHUNK_SPLATS);
}

/** The words of the `Chunk` structs of splats in storage order. */
export function chunksOf({
  count,
  positions,
  logScales,
}: Pick<SplatColumns, 'count' | 'positions' | 'logScales'>): Float32Array<ArrayBuffer> {
  const chunks = new Float32Array(chunkCountOf(count) * WORDS);
  for (let chunk = 0; chunk < chunkCountOf(count); chunk++) {
    const start = chunk * CHUNK_SPLATS;
    const end = Math.min(count, start + CHUNK_SPLATS);
    const bounds = emptyBounds();
    widenBounds(bounds, positions, start, end);
    let smallest = Number.POSITIVE_INFINITY;
    let largest = Number.NEGATIVE_INFINITY;
    for (let i = 3 * start; i < 3 * end; i++) {
      if (logScales[i] < smallest) smallest = logScales[i];
      if (logScales[i] > largest) largest = logScales[i];
    }
    chunks.set(bounds.min, chunk * WORDS + minPosition);
    chunks.set(bounds.max, chunk * WORDS + maxPosition);
    setLogScales(chunks, chunk, logScaleRange(clampLogScale(smallest), clampLogScale(largest)));
  }
  return chunks;
}

export function logScalesOf(chunks: Float32Array, chunk: number): LogScaleRange {
  return { min: chunks[chunk * WORDS + minLogScale], step: chunks[chunk * WORDS + logScaleStep] };
}

export function setLogScales(chunks: Float32Array, chunk: number, { min, step }: LogScaleRange): void {
  chunks[chunk * WORDS + minLogScale] = min;
  chunks[chunk * WORDS + logScaleStep] = step;
}

/** The largest standard deviation along any axis, with room for rounding: as in cull-chunks. */
export function maxScaleOf(chunks: Float32Array, chunk: number): number {
  const { min, step } = logScalesOf(chunks, chunk);
  return 1.001 * Math.exp(min + 65535 * step);
}
