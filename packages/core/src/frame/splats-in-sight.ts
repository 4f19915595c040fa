import type { FrustumSide } from '../data/camera/frustum.ts';
import { CHUNK_SPLATS } from '../data/layout/constants.ts';
import { countChunksInFrustum } from './chunk-groups.ts';
import type { CloudInstance } from './frame-request.ts';

/** A cloud of a frame, with the sides of the frustum in its space. */
export interface SidedCloud {
  readonly instance: Pick<CloudInstance, 'cloud'>;
  readonly sides: readonly FrustumSide[];
  /** Those of its instances; null, the default: it is drawn once. */
  readonly places?: readonly { readonly sides: readonly FrustumSide[] }[] | null;
}

/** Returns the splats of all chunks that may reach into the image: never less than are drawn. */
export function splatsInSight(clouds: readonly SidedCloud[]): number {
  const ofPlace = ({ count, chunks }: SidedCloud['instance']['cloud'], sides: readonly FrustumSide[]) =>
    Math.min(count, CHUNK_SPLATS * countChunksInFrustum(chunks, sides));
  return clouds.reduce(
    (sum, { instance: { cloud }, sides, places }) =>
      (places ?? [{ sides }]).reduce((total, place) => total + ofPlace(cloud, place.sides), sum),
    0,
  );
}
