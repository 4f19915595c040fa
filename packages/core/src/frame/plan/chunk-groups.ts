import type { FrustumSide } from '../../data/camera/frustum.ts';
import { CHUNK_WORDS } from '../../data/layout/chunk-words.ts';
import { maxScaleOf } from '../../data/packing/chunks.ts';

/** Chunks per group, and groups per larger group: Morton order makes those of a group neighbours. */
const GROUP = 16;
/** The GPU tests chunks in float32 with a slack of 1e-5; this test must keep all that it keeps. */
const SLACK = 1e-4;

const { minPosition: MIN, maxPosition: MAX, count: WORDS } = CHUNK_WORDS;

/** Bounds of chunks, or of groups of them. */
interface Bounds {
  /** As `Chunk` structs. */
  readonly corners: Float32Array;
  /** Largest standard deviation in each. */
  readonly maxScales: Float64Array;
}

/** Bounds by the chunks' buffer: of chunks, of groups of them, of groups of groups, and so on. */
const known = new WeakMap<ArrayBuffer, readonly Bounds[]>();

function boundsOf(buffer: ArrayBuffer): readonly Bounds[] {
  let levels = known.get(buffer);
  if (!levels) {
    const corners = new Float32Array(buffer);
    const maxScales = new Float64Array(corners.length / WORDS).map((_, i) => maxScaleOf(corners, i));
    const made: Bounds[] = [{ corners, maxScales }];
    while (made.at(-1)!.maxScales.length > GROUP) made.push(boundGroups(made.at(-1)!, GROUP));
    levels = made;
    known.set(buffer, levels);
  }
  return levels;
}

/**
 * Returns the number of chunks that may reach into a frustum: all that the GPU finds there, and a
 * few at its sides. A group that is wholly inside or outside decides for all of its chunks. Chunks of
 * other groups are tested only against the planes that cut their group.
 *
 * @param buffer one `Chunk` struct per chunk; must not change.
 */
export function countChunksInFrustum(buffer: ArrayBuffer, sides: readonly FrustumSide[]): number {
  const levels = boundsOf(buffer);
  const top = levels.length - 1;
  return countWithin(levels, top, 0, levels[top].maxScales.length, sides, allOf(sides));
}

/** Counts the chunks of groups `first` to `end` of a level. */
function countWithin(
  levels: readonly Bounds[],
  level: number,
  first: number,
  end: number,
  sides: readonly FrustumSide[],
  tested: number,
): number {
  const bounds = levels[level];
  const chunksEach = GROUP ** level;
  let count = 0;
  for (let at = first; at < end; at++) {
    const cut = planesThatCut(sides, tested, bounds, at);
    if (cut === OUTSIDE) continue;
    if (level === 0) count++;
    else if (cut === 0) count += Math.min(levels[0].maxScales.length - at * chunksEach, chunksEach);
    else {
      const last = Math.min(levels[level - 1].maxScales.length, GROUP * (at + 1));
      count += countWithin(levels, level - 1, GROUP * at, last, sides, cut);
    }
  }
  return count;
}

/** Bounds of all splats, with the largest scale of a blob, by the same buffer. */
const knownWhole = new WeakMap<ArrayBuffer, Bounds>();

/**
 * Whether any splat of a cloud may reach into a frustum, or any blob that stands for some of them.
 *
 * @param buffer as for `countChunksInFrustum`.
 */
export function mayReachIntoFrustum(buffer: ArrayBuffer, sides: readonly FrustumSide[]): boolean {
  let whole = knownWhole.get(buffer);
  if (!whole) {
    const [chunks] = boundsOf(buffer);
    whole = boundGroups(chunks, chunks.maxScales.length);
    const { corners, maxScales } = whole;
    const extents = [0, 1, 2].map((axis) => corners[MAX + axis] - corners[MIN + axis]);
    // A blob's variance is at most the variance of the centres that it merges plus the largest splat's.
    maxScales[0] = Math.hypot(0.5 * Math.hypot(...extents), maxScales[0]);
    knownWhole.set(buffer, whole);
  }
  return planesThatCut(sides, allOf(sides), whole, 0) !== OUTSIDE;
}

function boundGroups({ corners, maxScales }: Bounds, each: number): Bounds {
  const count = Math.ceil(maxScales.length / each);
  const grouped = { corners: new Float32Array(WORDS * count), maxScales: new Float64Array(count) };
  for (let i = 0; i < maxScales.length; i++) {
    const group = Math.floor(i / each);
    const isFirst = i % each === 0;
    for (let axis = 0; axis < 3; axis++) {
      const [low, high] = [WORDS * group + MIN + axis, WORDS * group + MAX + axis];
      const [ownLow, ownHigh] = [corners[WORDS * i + MIN + axis], corners[WORDS * i + MAX + axis]];
      grouped.corners[low] = isFirst ? ownLow : Math.min(grouped.corners[low], ownLow);
      grouped.corners[high] = isFirst ? ownHigh : Math.max(grouped.corners[high], ownHigh);
    }
    grouped.maxScales[group] = Math.max(grouped.maxScales[group], maxScales[i]);
  }
  return grouped;
}

/** Bounds are wholly outside of a plane. */
const OUTSIDE = -1;

/** A bit for each plane. */
function allOf(sides: readonly FrustumSide[]): number {
  return 2 ** sides.length - 1;
}

/**
 * Returns a bit for each of the `tested` planes that cut bounds, with all that their splats reach; OUTSIDE if one of
 * them has all of it behind. The result also holds for parts of the bounds: a part's nearest corner is no nearer to a
 * plane, and its slack is no larger.
 */
function planesThatCut(
  sides: readonly FrustumSide[],
  tested: number,
  { corners, maxScales }: Bounds,
  index: number,
): number {
  const at = WORDS * index;
  let cut = 0;
  for (let i = 0; i < sides.length; i++) {
    if ((tested & (1 << i)) === 0) continue;
    const { normal, offset, reach } = sides[i];
    const extent = reach * maxScales[index];
    let nearest = offset + extent;
    let farthest = offset;
    let magnitude = Math.abs(offset) + extent;
    for (let axis = 0; axis < 3; axis++) {
      const low = normal[axis] * corners[at + MIN + axis];
      const high = normal[axis] * corners[at + MAX + axis];
      nearest += Math.max(low, high);
      farthest += Math.min(low, high);
      magnitude += Math.abs(low) + Math.abs(high);
    }
    if (nearest + SLACK * magnitude < 0) return OUTSIDE;
    if (!(farthest >= 0)) cut |= 1 << i;
  }
  return cut;
}
