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
  /** The view that "Reset the view" goes to, whichever axis is up now. */
  readonly home: KeptView;
  /** Index of the own camera of the scene that was chosen last. */
  readonly cameraIndex: number;
}

/** The parts of a camera that its picture depends on. */
export type ViewedCamera = Omit<KeptView, 'isZUp'>;

/** Camera of a link: a snapshot without the pose to reset to. */
export type LinkedCamera = Omit<CameraSnapshot, 'home'>;

/**
 * How a path passes a view: without slowing down, with a stop, or holding it until it jumps to the
 * next one.
 */
export const PASSINGS = ['through', 'stop', 'cut'] as const;
export type Passing = (typeof PASSINGS)[number];

/** Time from one view of a path to the next unless a person sets another, ms. */
export const USUAL_STEP_MS = 2500;
/** Shortest time from one view to the next, ms; times are whole multiples of it. */
export const LEAST_STEP_MS = 100;

/** A view of a scene that a person has saved. */
export interface SavedView extends KeptView {
  /** Empty without one. */
  readonly name: string;
  /** A small JPEG image, base64; null until it is drawn, since links have none. */
  readonly thumbnail: string | null;
  /** Time on the path to the next view, ms; `USUAL_STEP_MS` if absent. */
  readonly toNextMs?: number;
  /** `through` if absent. */
  readonly passing?: Passing;
}

/** A view's name, or its place in the list. */
export function viewName({ name }: Pick<SavedView, 'name'>, index: number): string {
  return name.trim() || `View ${index + 1}`;
}

/** Once around the target of a view. */
export interface Turntable {
  readonly view: KeptView;
  readonly durationMs: number;
}

/** What the path of a scene has besides its saved views. */
export interface PathSettings {
  /** Whether the path goes on from its last view to the first. */
  readonly isLooped: boolean;
  /** The path in place of the one through saved views; null without one. */
  readonly turntable: Turntable | null;
}

export const FIRST_PATH: PathSettings = { isLooped: false, turntable: null };

export interface SavedViewsState {
  /** Views that a person has saved of this scene. */
  readonly savedViews: readonly SavedView[];
  readonly path: PathSettings;
  /** Whether the camera follows the path through the saved views, or the path of settings. */
  readonly isPathPlaying: boolean;
  /** Time on the path at which it is shown, or was last, ms. */
  readonly playheadMs: number;
  /** Whether the strip with the path is below the picture. */
  readonly isPathVisible: boolean;
}

export const FIRST_SAVED_VIEWS: SavedViewsState = {
  savedViews: [],
  path: FIRST_PATH,
  isPathPlaying: false,
  playheadMs: 0,
  isPathVisible: false,
};
