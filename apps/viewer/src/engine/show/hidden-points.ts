import { flippedPoint } from '../../camera/flip.ts';
import type { Vec3 } from '../../state/vec3.ts';
import type { Viewer } from '../viewer.ts';

/**
 * Splats hide a point if they are nearer by more than this fraction of its depth: splats of one
 * surface differ by less.
 */
const NEARER_PART = 0.03;
/** Opacity of all splats in front of a point from which it counts as hidden. */
const HIDING_OPACITY = 0.5;

/**
 * Asks whether splats hide these points of the scene in the frame on the screen: at most 1,024, as
 * `view.coverage` takes. Null for a point outside of the picture, and for all if that frame has gone.
 */
export async function hiddenPoints(
  viewer: Pick<Viewer, 'shownFrame' | 'askShown'>,
  points: readonly Vec3[],
): Promise<readonly (boolean | null)[] | null> {
  const { shownFrame } = viewer;
  if (!shownFrame || points.length === 0) return null;
  const { viewMatrix: m } = shownFrame.frame.camera;
  const asked = points.map((each) => {
    const point = shownFrame.isFlipped ? flippedPoint(each) : each;
    const depthView = -(m[2] * point[0] + m[6] * point[1] + m[10] * point[2] + m[14]);
    return { point, tolerance: Math.max(0, NEARER_PART * depthView) };
  });
  const covered = await viewer.askShown((view) => view.coverage(asked));
  return covered?.map(({ isInImage, opacity }) => (isInImage ? opacity > HIDING_OPACITY : null)) ?? null;
}
