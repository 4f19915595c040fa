import type { FrustumSide } from '../data/camera/frustum.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { countChunksInFrustum } from './chunk-groups.ts';
import type { CloudInstance } from './frame-request.ts';

/** A cloud of a frame, with the sides of the frustum in its space. */
export interface SidedCloud {
  readonly instance: Pick<CloudInstance, 'cloud'>;
  readonly sides: readonly FrustumSide[];
}

/** Returns the splats of all chunks that may reach into the image: never less than are drawn. */
export function splatsInSight(clouds: readonly SidedCloud[]): number {
  return clouds.reduce((sum, { instance: { cloud }, sides }) => {
    return sum + Math.min(cloud.count, CHUNK_SPLATS * countChunksInFrustum(cloud.chunks, sides));
  }, 0);
}
