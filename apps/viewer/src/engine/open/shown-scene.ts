import {
  type CloudInstance,
  type DropCounts,
  type DropReason,
  type FrameSceneOptions,
  frameScene,
  type SceneFraming,
  type SplatCloud,
  type SplatFileError,
} from '@websplatter/core';
import { boundingSphere, boundsOf } from '../../camera/scene-bounds.ts';
import type { CameraSubject } from '../../camera/view-camera.ts';
import type { CameraSnapshot } from '../../state/saved-view.ts';
import type { LoadState, SceneAbout, SceneSummary } from '../../state/scene.ts';
import type { PartLook, ScenePartSummary } from '../../state/scene-part.ts';
import type { UpAxis } from '../../state/up-axis.ts';
import type { Session } from '../show/session.ts';
import { type SceneSource, titleOf, titleOfAll } from './scene-source.ts';

/** A scene on the GPU, with its cameras. */
export interface LoadedScene extends Pick<CameraSubject, 'firstView' | 'ownCameras' | 'isUpsideDown'> {
  readonly clouds: readonly CloudInstance[];
  /** Index of the frame that `clouds` holds, once a file of frames has shown another than its first. */
  readonly frame?: number;
  readonly about: SceneAbout | null;
  /** Set for a hard case that must be refused: the error that refused it. */
  readonly refusal?: SplatFileError;
  /** Why only a sample of the file was loaded. */
  readonly sampleFailure?: Error;
}

export interface LoadSceneOptions {
  readonly signal: AbortSignal;
  readonly onProgress: (progress: Omit<LoadState, 'title'>) => void;
  /** Files with more bytes are converted for streaming if possible. */
  readonly keepAboveBytes: number;
  /** Called repeatedly with the part that can be drawn so far; see `LoadOptions.onPreview`. */
  readonly onPreview: (preview: LoadedScene) => void;
}

/** A file of a scene: its loaded data, and its look. */
export interface ShownPart {
  /** Stays the same while the file is in the scene, also if it is opened again. */
  readonly key: number;
  readonly source: SceneSource;
  /** See `contentKeyOf`. */
  readonly contentKey: string;
  readonly loaded: LoadedScene;
  readonly look: PartLook;
}

/** The usual way up of a scene's files. */
export interface SceneFrame extends Pick<CameraSubject, 'isUpsideDown'> {
  /** `filesOf` the scene whose first view it has; default: the scene itself. */
  readonly firstFiles?: string;
}

/** A scene that is on the screen, or will be with the next frame. */
export interface ShownScene extends Omit<CameraSubject, 'framing' | 'detail'> {
  /** Unique on this page; stays the same while only the looks of files change. */
  readonly id: number;
  /** The session that owns the clouds. */
  readonly session: Session;
  /** One or more, in the order of opening. */
  readonly parts: readonly ShownPart[];
  /** The clouds to draw: hidden files have none. */
  readonly clouds: readonly CloudInstance[];
  readonly about: SceneAbout | null;
  /** `filesOf` the scene at its first view. */
  readonly firstFiles: string;
}

/** A replaced scene, and the camera with which it was shown. */
export interface ReplacedScene {
  readonly scene: ShownScene;
  readonly camera: CameraSnapshot;
}

/** @param frame way up and first view of the scene; default: the first file's, and a view of its own. */
export function shownScene(
  id: number,
  session: Session,
  parts: readonly ShownPart[],
  frame: SceneFrame = parts[0].loaded,
): ShownScene {
  const clouds = parts.filter(({ look }) => !look.isHidden).flatMap(drawnClouds);
  // If everything is hidden, the camera keeps the bounds of all files.
  const bounded = clouds.length > 0 ? clouds : parts.flatMap(drawnClouds);
  const [{ loaded, look }] = parts;
  const isAlone = parts.length === 1;
  const files = filesOf(parts);
  const { firstFiles = files } = frame;
  return {
    id,
    session,
    parts,
    clouds,
    about: isAlone ? loaded.about : null,
    ownCameras: isAlone ? loaded.ownCameras : null,
    firstView: isAlone && look.placement === null ? loaded.firstView : null,
    isUpsideDown: frame.isUpsideDown,
    firstFiles,
    hasOtherFiles: files !== firstFiles,
    sphere: boundingSphere(boundsOf(bounded, 'robustBounds')),
    extent: boundingSphere(boundsOf(bounded, 'bounds')),
  };
}

/** Key of files and of how they are drawn. */
function filesOf(parts: readonly ShownPart[]): string {
  return JSON.stringify(parts.map(({ key, look: { modelMatrix, ...look } }) => [key, look]));
}

function drawnClouds({ loaded, look }: ShownPart): readonly CloudInstance[] {
  const { opacity, modelMatrix } = look;
  if (opacity === 1 && !modelMatrix) return loaded.clouds;
  return loaded.clouds.map((instance) => ({
    ...instance,
    modelMatrix: modelMatrix ?? instance.modelMatrix,
    opacity,
  }));
}

/** Clouds of all files, including hidden ones. */
export function allClouds({ parts }: Pick<ShownScene, 'parts'>): SplatCloud[] {
  return parts.flatMap(({ loaded }) => loaded.clouds.map(({ cloud }) => cloud));
}

/**
 * Key of each drawn cloud, stable while its file is in the scene. Each frame of a file of frames has its
 * own: frames number their splats differently.
 */
export function cloudKeys({ parts }: Pick<ShownScene, 'parts'>): string[] {
  const drawn = parts.filter(({ look }) => !look.isHidden);
  return drawn.flatMap(partCloudKeys);
}

function partCloudKeys({ key, loaded }: Pick<ShownPart, 'key' | 'loaded'>): string[] {
  return loaded.clouds.map((_, i) => cloudKey(key, loaded.frame ?? i));
}

/** Key of the cloud at `index` in a file, or of its frame. */
export function cloudKey(partKey: number, index: number): string {
  return `${partKey}/${index}`;
}

/** The axis that mostly points up in the scene's files. */
export function ownUp({ isUpsideDown }: SceneFrame): UpAxis {
  return isUpsideDown ? '-y' : 'y';
}

interface FramedScene {
  /** Null if no splat can be seen. */
  readonly framing: SceneFraming | null;
  /** False after files were added, hidden or moved. */
  readonly isCurrent: boolean;
}

/** Computes and caches the first views of scenes. */
export class SceneFramer {
  readonly #found = new WeakMap<ShownScene, FramedScene>();

  /** @throws as `frameScene`. */
  async frame(scene: ShownScene, options: FrameSceneOptions): Promise<void> {
    const framing = await frameScene(scene.clouds, options);
    this.#found.set(scene, { framing, isCurrent: true });
  }

  /**
   * Reuses the first view of `scene` for `next`. If `isCurrent` is false, it stays the way the
   * scene began, without fitting its present parts.
   */
  keep(scene: ShownScene, next: ShownScene, isCurrent: boolean): void {
    const found = this.#found.get(scene);
    if (found) this.#found.set(next, { framing: found.framing, isCurrent: isCurrent && found.isCurrent });
  }

  isCurrent(scene: ShownScene): boolean {
    return this.#found.get(scene)?.isCurrent ?? false;
  }

  framingOf(scene: ShownScene): SceneFraming | null {
    return this.#found.get(scene)?.framing ?? null;
  }

  /** The scene data that the camera needs. */
  subjectOf(scene: ShownScene): CameraSubject {
    const framing = this.framingOf(scene);
    const detail =
      framing && this.isCurrent(scene) ? { center: framing.center, radius: framing.radius } : null;
    return { ...scene, framing, detail };
  }
}

export function summaryOf(scene: ShownScene, cameras: readonly string[]): SceneSummary {
  const { parts, about, ownCameras, isUpsideDown } = scene;
  const clouds = allClouds(scene);
  return {
    title: titleOfAll(parts.map(({ source }) => source)),
    contentKey: parts[0].contentKey,
    parts: parts.map(partSummary),
    clouds: clouds.length,
    splats: clouds.reduce((sum, { count }) => sum + count, 0),
    declaredShDegree: Math.max(0, ...clouds.map(({ facts }) => facts.declaredShDegree)),
    shDegree: Math.max(0, ...clouds.map(({ shDegree }) => shDegree)),
    dropped: mergedDrops(clouds.map(({ dropped }) => dropped)),
    // Files of frames note that a load shows their first frame only. The viewer plays them.
    notes: [
      ...new Set(
        clouds.flatMap(({ facts: { fileFacts } }) => (!fileFacts?.frames && fileFacts?.notes) || []),
      ),
    ],
    about,
    cameras,
    // Own cameras show the scene as it is; turned, it would be another one.
    canFlip: ownCameras === null,
    isUpsideDown,
    canSave: parts.some(({ source, look }) => source.kind !== 'hard-case' && !look.isHidden),
  };
}

/** Sums the rows that several clouds left out, by reason. */
function mergedDrops(drops: readonly DropCounts[]): DropCounts {
  const merged: DropCounts = {};
  for (const [reason, count] of drops.flatMap((each) => Object.entries(each) as [DropReason, number][]))
    if (count > 0) merged[reason] = (merged[reason] ?? 0) + count;
  return merged;
}

function partSummary({ key, source, loaded, look }: ShownPart): ScenePartSummary {
  const { center, radius } = boundingSphere(boundsOf(loaded.clouds, 'robustBounds'));
  return {
    key,
    title: titleOf(source),
    splats: loaded.clouds.reduce((sum, { cloud }) => sum + cloud.count, 0),
    cloudKeys: partCloudKeys({ key, loaded }),
    look,
    canPlace: source.kind !== 'hard-case',
    ownUp: ownUp(loaded),
    middle: center,
    radius,
  };
}
