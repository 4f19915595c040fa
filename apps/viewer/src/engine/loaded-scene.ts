import type { CloudInstance, SplatFileError } from '@websplatter/core';
import type { CameraSubject } from '../camera/view-camera.ts';
import type { LoadState, SceneAbout } from '../state/scene.ts';

/** A scene on the GPU, and how it is to be looked at. */
export interface LoadedScene extends Pick<CameraSubject, 'firstView' | 'ownCameras' | 'isUpsideDown'> {
  readonly clouds: readonly CloudInstance[];
  readonly about: SceneAbout | null;
  /** Why a file has no splats whose refusal is what the scene shows. */
  readonly refusal?: SplatFileError;
  /** Why there is only a sample of the file. */
  readonly sampleFailure?: Error;
}

export interface LoadSceneOptions {
  readonly signal: AbortSignal;
  readonly onProgress: (progress: Omit<LoadState, 'title'>) => void;
  /** Larger files are arranged for streaming where that is possible. */
  readonly keepAboveBytes: number;
  /** Called with what can be shown already, again and again: see `LoadOptions.onPreview`. */
  readonly onPreview: (preview: LoadedScene) => void;
}
