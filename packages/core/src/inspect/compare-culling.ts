import type { AccuracySettings } from '../data/accuracy/accuracy.ts';
import type { Projection } from '../data/camera/camera.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { orderedBits } from '../data/layout/depth-key.ts';
import { Chunk } from '../data/layout/structs.ts';
import { maxScaleOf } from '../data/packing/chunks.ts';
import { chunkClearance, cullSplat } from '../stages/cull/cull.reference.ts';
import { FLOAT32_ROUNDING, projectionErrors } from './error-bounds.ts';
import type { InspectedCloud, InspectedFrame } from './inspected-frame.ts';
import { sortDepths } from './sort-depths.ts';

/** A splat that the GPU drew and the reference culls, or the reverse. */
export interface CullingMismatch {
  readonly cloudIndex: number;
  readonly splatIndex: number;
  readonly expected: 'drawn' | 'culled';
  readonly got: 'drawn' | 'culled';
}

/** Differences between the splats that a frame drew and the splats that the reference draws. */
export interface CullingComparison {
  readonly visibleCount: number;
  /** Splats so close to a threshold that rounding may decide either way. */
  readonly unsureCount: number;
  /** Wrongly drawn or wrongly culled splats, in storage order. */
  readonly mismatches: readonly CullingMismatch[];
  /** Flaws of the list of visible splats and of the range of depths. */
  readonly flaws: readonly string[];
}

/** Compares the splats that the frame drew with the splats that the float64 reference draws. */
export async function compareCulling(frame: InspectedFrame): Promise<CullingComparison> {
  const visibleCount = await frame.visibleCount();
  const visibleSplats = (await frame.words('visibleSplats')).subarray(0, visibleCount);
  const drawn = new Set(visibleSplats);
  const flaws: string[] = [];
  if (!visibleSplats.every((splat, i) => i === 0 || visibleSplats[i - 1] < splat))
    flaws.push('The visible splats are not listed exactly once each in storage order.');
  for (const flaw of await depthRangeFlaws(frame)) flaws.push(flaw);

  let unsureCount = 0;
  const mismatches: CullingMismatch[] = [];
  let firstSplat = 0;
  for (const [cloudIndex, cloud] of frame.clouds.entries()) {
    for (let splatIndex = 0; splatIndex < cloud.stored.count; splatIndex++) {
      const { isDrawn, isSure } = verdict(cloud, splatIndex, frame.projection, frame.accuracy);
      const expected = isDrawn ? 'drawn' : 'culled';
      const got = drawn.has(firstSplat + splatIndex) ? 'drawn' : 'culled';
      if (!isSure) unsureCount++;
      else if (got !== expected) mismatches.push({ cloudIndex, splatIndex, expected, got });
    }
    firstSplat += 256 * Math.ceil(cloud.stored.count / 256);
  }
  return { visibleCount, unsureCount, mismatches, flaws };
}

/**
 * Whether the reference draws the splat, and whether that is sure or rounding may decide otherwise:
 * the reference runs again with cutoff, near, far and the image's edges moved by float32's largest
 * error, once against the splat and once in its favour.
 */
function verdict(
  cloud: InspectedCloud,
  index: number,
  projection: Projection,
  { alphaCutoff, extent, culling }: AccuracySettings,
) {
  const { stored, view, effects, dilationPx2 } = cloud;
  // Splats of chunks out of sight fail any test against the image anyway.
  const clearance = culling === 'frustum' ? clearanceOfChunk(cloud, index) : Number.POSITIVE_INFINITY;
  if (clearance < -CHUNKS_KEPT_BEYOND) return { isDrawn: false, isSure: true };
  const errors = projectionErrors(stored, index, view, projection);
  const drawn = (direction: -1 | 0 | 1) => {
    // A Gaussian reaches 3.4 standard deviations at most: its extent errs by as many rows' errors.
    const edgePx = (axis: 0 | 1) => direction * (errors.centerPx[axis] + 4 * errors.rowsPx + 1e-5);
    const moved = {
      ...projection,
      widthPx: projection.widthPx + 2 * edgePx(0),
      heightPx: projection.heightPx + 2 * edgePx(1),
      centerPx: [projection.centerPx[0] + edgePx(0), projection.centerPx[1] + edgePx(1)] as const,
      near: projection.near - direction * (errors.depthView + FLOAT32_ROUNDING * Math.abs(projection.near)),
      far: projection.far + direction * (errors.depthView + FLOAT32_ROUNDING * Math.abs(projection.far)),
    };
    // Opacity and cutoff are rounded to float32, and `log` errs by 3 ulp: like another cutoff.
    const cutoff = alphaCutoff * (1 - direction * 16 * FLOAT32_ROUNDING);
    const settings = {
      alphaCutoff: cutoff,
      dilationPx2,
      effects,
      extent,
      culling,
    };
    return cullSplat(stored, index, view, moved, settings) !== null;
  };
  const isChunkSure = clearance >= 0 || !drawn(1);
  return { isDrawn: drawn(0), isSure: isChunkSure && drawn(-1) === drawn(1) };
}

/**
 * The shader keeps chunks that fail the test of a side by less than 1e-5 of its terms, and its own
 * rounding of about ten operations on float32 uniforms is below 20 · 2^-24 = 1.2e-6 of them.
 */
const CHUNKS_KEPT_BEYOND = 1.2e-5;

/** `chunkClearance` of the chunk that contains splat `index`. */
function clearanceOfChunk({ packed, planes }: InspectedCloud, index: number): number {
  const chunk = Math.floor(index / CHUNK_SPLATS);
  const vector = (offset: number) => new Float32Array(packed.chunks, chunk * Chunk.bytes + offset, 3);
  const bounds = {
    minPosition: vector(Chunk.offsets.minPosition),
    maxPosition: vector(Chunk.offsets.maxPosition),
    maxScale: maxScaleOf(new Float32Array(packed.chunks), chunk),
  };
  return chunkClearance(bounds, planes);
}

/** Compares the frame's range of depths with its splats' depths: equal bits; distances within bounds. */
async function depthRangeFlaws(frame: InspectedFrame): Promise<string[]> {
  const depths = await sortDepths(frame);
  if (depths.length === 0) return [];
  const least = depths.map((depth) => orderedBits(depth.least));
  const most = depths.map((depth) => orderedBits(depth.most));
  const pick = (choose: (a: number, b: number) => number) =>
    [least, most].map((bits) => bits.reduce((a, b) => choose(a, b)));
  const [farthest, nearestInverted] = await frame.words('depthRange');
  const flaws: string[] = [];
  for (const [name, bits, [from, to]] of [
    ['farthest', farthest, pick(Math.max)],
    ['nearest', ~nearestInverted >>> 0, pick(Math.min)],
  ] as const) {
    if (bits >= from && bits <= to) continue;
    flaws.push(`The ${name} depth has bits ${bits}, expected ${from === to ? from : `${from} to ${to}`}.`);
  }
  return flaws;
}
