import type { FrustumSide } from '../camera/frustum.ts';
import { CHUNK_SPLATS } from '../layout/constants.ts';
import { Chunk } from '../layout/structs.ts';
import type { CloudPlan } from './cloud-plan.ts';
import { LEAST_USE } from './recent-peak.ts';

/** Up to this count, room for all splats (about 15 MB) is cheaper than finding out how many are visible. */
const ALWAYS_ROOM_FOR = 1 << 18;
/** Spare room, so that a moving camera does not need larger buffers every frame. */
const HEADROOM = 1.25;
/** The GPU tests chunks in float32 with a slack of 1e-5; this test must keep every chunk that the GPU keeps. */
const SLACK = 1e-4;

type SidedCloud = Pick<CloudPlan, 'instance' | 'sides'>;

/**
 * Returns a number of splats that is never less than the visible ones of a frame of `clouds`. The CPU tests the chunks as
 * the GPU will, so nothing has to be read back, and no image ever lacks splats for lack of room.
 */
export function mostVisibleSplats(clouds: readonly SidedCloud[]): number {
  const total = clouds.reduce((sum, { instance }) => sum + instance.cloud.count, 0);
  return total <= ALWAYS_ROOM_FOR ? total : Math.min(total, CHUNK_SPLATS * countVisibleChunks(clouds));
}

/**
 * Returns the number of visible splats to make room for: at least `needed`.
 *
 * @param needed `mostVisibleSplats` of the frame.
 * @param total number of splats of the frame's clouds.
 * @param current number of splats that there is room for already; kept while it suits.
 * @param recent the largest need of recent frames of the same clouds.
 */
export function visibleCapacity(needed: number, total: number, current: number, recent: number): number {
  const peak = Math.max(needed, recent);
  if (needed <= current && peak >= LEAST_USE * current) return current;
  return Math.min(total, Math.ceil((peak * HEADROOM) / CHUNK_SPLATS) * CHUNK_SPLATS);
}

function countVisibleChunks(clouds: readonly SidedCloud[]): number {
  let count = 0;
  for (const { instance, sides } of clouds) {
    const chunks = new Float32Array(instance.cloud.chunks);
    for (let at = 0; at < chunks.length; at += Chunk.bytes / 4) if (isInFrustum(chunks, at, sides)) count++;
  }
  return count;
}

const MIN = Chunk.offsets.minPosition / 4;
const MAX = Chunk.offsets.maxPosition / 4;
const SCALE = Chunk.offsets.maxScale / 4;

function isInFrustum(chunks: Float32Array, at: number, sides: readonly FrustumSide[]): boolean {
  for (const { normal, offset, reach } of sides) {
    let best = offset + reach * chunks[at + SCALE];
    let magnitude = Math.abs(offset) + reach * chunks[at + SCALE];
    for (let axis = 0; axis < 3; axis++) {
      const low = normal[axis] * chunks[at + MIN + axis];
      const high = normal[axis] * chunks[at + MAX + axis];
      best += Math.max(low, high);
      magnitude += Math.abs(low) + Math.abs(high);
    }
    if (best + SLACK * magnitude < 0) return false;
  }
  return true;
}
