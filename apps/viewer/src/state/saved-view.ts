import type { OrbitPose } from './orbit-pose.ts';
import type { Uprightness } from './up-axis.ts';

/** A view of a scene, to come back to. */
export interface KeptView extends Uprightness {
  readonly pose: OrbitPose;
  readonly fovDegrees: number;
  readonly isOrthographic: boolean;
}

/** The camera's state, for links and to return to. */
export interface CameraSnapshot extends KeptView {
  /** Pose that "Reset the view" goes to. */
  readonly home: OrbitPose;
  /** Index of the own camera of the scene that was chosen last. */
  readonly cameraIndex: number;
}

/** The parts of a camera that its picture depends on. */
export type ViewedCamera = Omit<KeptView, 'isZUp'>;

/** Camera of a link: a snapshot without the pose to reset to. */
export type LinkedCamera = Omit<CameraSnapshot, 'home'>;

/** A view of a scene that a person has saved. */
export interface SavedView extends KeptView {
  /** Empty without one. */
  readonly name: string;
  /** A small JPEG image, base64; null until it is drawn, since links have none. */
  readonly thumbnail: string | null;
}

/** A view's name, or its place in the list. */
export function viewName({ name }: Pick<SavedView, 'name'>, index: number): string {
  return name.trim() || `View ${index + 1}`;
}

export interface SavedViewsState {
  /** Views that a person has saved of this scene. */
  readonly savedViews: readonly SavedView[];
  /** Whether the camera follows the path through the saved views, or the path of settings. */
  readonly isPathPlaying: boolean;
}

export const FIRST_SAVED_VIEWS: SavedViewsState = { savedViews: [], isPathPlaying: false };
