import { boundingSphere, boundsOf } from '../camera/scene-bounds.ts';
import type { CameraSnapshot, CameraSubject } from '../camera/view-camera.ts';
import type { Session } from '../session/session.ts';
import type { SceneSummary } from '../state/scene-summary.ts';
import { mergedDrops } from './dropped-splats.ts';
import type { LoadedScene } from './load-scene.ts';
import { type SceneSource, titleOf } from './scene-source.ts';

/** A scene that is on the screen, or will be with the next frame. */
export interface ShownScene extends LoadedScene, CameraSubject {
  /** Another number for each scene that this page has shown. */
  readonly id: number;
  /** The clouds go with their session. */
  readonly session: Session;
  readonly source: SceneSource;
}

/** A scene that is no longer asked for, and how the camera looked at it. */
export interface ReplacedScene {
  readonly scene: ShownScene;
  readonly camera: CameraSnapshot;
}

export function shownScene(
  id: number,
  session: Session,
  source: SceneSource,
  loaded: LoadedScene,
): ShownScene {
  const { clouds } = loaded;
  return {
    ...loaded,
    id,
    session,
    source,
    sphere: boundingSphere(boundsOf(clouds, 'robustBounds')),
    extent: boundingSphere(boundsOf(clouds, 'bounds')),
  };
}

export function summaryOf(
  { clouds, source, about, ownCameras, isUpsideDown }: ShownScene,
  cameras: readonly string[],
): SceneSummary {
  return {
    title: titleOf(source),
    clouds: clouds.length,
    splats: clouds.reduce((sum, { cloud }) => sum + cloud.count, 0),
    declaredShDegree: Math.max(0, ...clouds.map(({ cloud }) => cloud.facts.declaredShDegree)),
    shDegree: Math.max(0, ...clouds.map(({ cloud }) => cloud.shDegree)),
    dropped: mergedDrops(clouds.map(({ cloud }) => cloud.dropped)),
    about,
    cameras,
    // Own cameras show the scene as it is; turned, it would be another one.
    canFlip: ownCameras === null,
    isUpsideDown,
    canSave: source.kind !== 'hard-case' && source.kind !== 'urls',
  };
}
