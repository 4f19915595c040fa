import { writerOf } from '../../clouds/cloud-feature.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { mayReachIntoFrustum } from './chunk-groups.ts';
import { countInstances } from './cloud-instances.ts';
import type { CloudPlan } from './cloud-plan.ts';
import type { CloudInstance } from './frame-request.ts';
import { type CutBudget, splatsInSight } from './level-cut.ts';
import { LEAST_USE } from './recent-peak.ts';

/** Up to this count, room for all splats (about 15 MB) is cheaper than counting visible ones. */
const ALWAYS_ROOM_FOR = 1 << 18;
/** Spare room, so that a moving camera does not need larger buffers every frame. */
const HEADROOM = 1.25;

type CutCloud = Pick<CloudPlan, 'instance'> & Partial<Pick<CloudPlan, 'cut' | 'isTouched' | 'places'>>;
type SidedCloud = CutCloud & Pick<CloudPlan, 'sides'>;

/** Splats per placement that no budget removes: the coarsest cut is a root cell of sixteen blobs. */
const LEAST_OF_PLACE = CHUNK_SPLATS;

/** Upper bound of a cloud's splats and blobs in memory, over all its placements. */
function mostOf(instance: CloudInstance): number {
  const { pool, count } = instance.cloud;
  return (pool?.capacity ?? count) * countInstances(instance);
}

/** Upper bound of the splats that a frame of `clouds` draws, for any camera. */
export function mostDrawnSplats(clouds: readonly CutCloud[], budget: CutBudget | null = null): number {
  const total = clouds.reduce((sum, { instance }) => sum + mostOf(instance), 0);
  if (budget) {
    const most = clouds.map(({ cut, isTouched, instance }) =>
      // Touched splats are drawn besides.
      cut && !isTouched ? LEAST_OF_PLACE * countInstances(instance) : mostOf(instance),
    );
    return Math.min(
      total,
      most.reduce((sum, count) => sum + count, budget.splats),
    );
  }
  // Beside others, the splats left out might be theirs.
  return clouds.length === 1 && !clouds[0].instance.instances
    ? Math.min(total, clouds[0].instance.cloud.visibleLimit)
    : total;
}

/**
 * Returns a number of splats that is never less than a frame of `clouds` draws. The CPU
 * tests the chunks as the GPU will, so nothing has to be read back, and no image ever lacks splats
 * for lack of room.
 */
export function mostVisibleSplats(clouds: readonly SidedCloud[], budget: CutBudget | null = null): number {
  const total = mostDrawnSplats(clouds, budget);
  if (total <= ALWAYS_ROOM_FOR) return total;
  const seen = clouds.map((cloud) => (cloud.cut ? mostOfCut(cloud) : splatsInSight([cloud])));
  return Math.min(
    total,
    seen.reduce((sum, count) => sum + count, 0),
  );
}

/** Most splats and blobs of a cloud's cuts: all, in places of which anything is in sight. */
function mostOfCut({ instance, places }: SidedCloud): number {
  const { cloud } = instance;
  // Blobs of edited splats may still be at the splats' old places.
  if (!places || writerOf(cloud)) return mostOf(instance);
  return cloud.count * places.filter(({ sides }) => mayReachIntoFrustum(cloud.chunks, sides)).length;
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
