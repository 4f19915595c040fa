import type { CloudInstance, SplatFileError } from '@websplatter/core';
import type { CameraSubject } from '../camera/view-camera.ts';
import type { LoadState, SceneAbout } from '../state/scene.ts';

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
