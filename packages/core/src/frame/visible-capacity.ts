import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { countChunksInFrustum } from './chunk-groups.ts';
import type { CloudPlan } from './cloud-plan.ts';
import { LEAST_USE } from './recent-peak.ts';

/** Up to this count, room for all splats (about 15 MB) is cheaper than counting visible ones. */
const ALWAYS_ROOM_FOR = 1 << 18;
/** Spare room, so that a moving camera does not need larger buffers every frame. */
const HEADROOM = 1.25;

type SidedCloud = Pick<CloudPlan, 'instance' | 'sides'> & Partial<Pick<CloudPlan, 'cut'>>;

/** Returns the number of splats that frames of `clouds` never exceed, whatever is in sight. */
export function mostDrawnSplats(clouds: readonly Pick<CloudPlan, 'instance'>[]): number {
  const total = clouds.reduce((sum, { instance }) => sum + instance.cloud.count, 0);
  // Beside others, the splats left out might be theirs.
  return clouds.length === 1 ? Math.min(total, clouds[0].instance.cloud.visibleLimit) : total;
}

/**
 * Returns a number of splats that is never less than those that a frame of `clouds` draws. The CPU
 * tests the chunks as the GPU will, so nothing has to be read back, and no image ever lacks splats
 * for lack of room.
 */
export function mostVisibleSplats(clouds: readonly SidedCloud[]): number {
  const total = mostDrawnSplats(clouds);
  // Blobs may reach into the image where none of their splats does.
  if (total <= ALWAYS_ROOM_FOR || clouds.some(({ cut }) => cut)) return total;
  const chunks = clouds.reduce(
    (sum, { instance, sides }) => sum + countChunksInFrustum(instance.cloud.chunks, sides),
    0,
  );
  return Math.min(total, CHUNK_SPLATS * chunks);
}

/**
 * Returns the number of visible splats to make room for: at least `needed`.
 *
 * @param needed `mostVisibleSplats` of the frame.
 * @param total `mostDrawnSplats` of the frame.
 * @param current number of splats that there is room for already; kept while it suits.
 * @param recent the largest need of recent frames of the same clouds.
 */
export function visibleCapacity(needed: number, total: number, current: number, recent: number): number {
  const peak = Math.max(needed, recent);
  if (needed <= current && peak >= LEAST_USE * current) return current;
  return Math.min(total, Math.ceil((peak * HEADROOM) / CHUNK_SPLATS) * CHUNK_SPLATS);
}
