import type { OrbitPose } from '../camera/orbit-pose.ts';
import type { Uprightness } from '../camera/up-axis.ts';

/** A view of a scene that a person has saved. */
export interface SavedView extends Uprightness {
  readonly pose: OrbitPose;
  readonly fovDegrees: number;
  readonly isOrthographic: boolean;
  /** A small JPEG image, base64. */
  readonly thumbnail: string;
}
