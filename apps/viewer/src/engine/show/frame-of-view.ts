import type { FrameRequest } from '@websplatter/core';
import { flippedMatrix } from '../../camera/flip.ts';
import type { ViewCamera } from '../../camera/view-camera.ts';
import type { ViewedCamera } from '../../state/saved-view.ts';

/**
 * Another view of a frame's scene, in an image of another size.
 *
 * @param isFlipped whether the scene is the other way up in `frame`.
 */
export function frameOfView(
  frame: FrameRequest,
  isFlipped: boolean,
  camera: ViewCamera,
  view: ViewedCamera,
  { widthPx, heightPx }: Pick<FrameRequest, 'widthPx' | 'heightPx'>,
): FrameRequest {
  const clouds =
    view.isFlipped === isFlipped
      ? frame.clouds
      : frame.clouds.map((cloud) => ({ ...cloud, modelMatrix: flippedMatrix(cloud.modelMatrix) }));
  return { ...frame, clouds, camera: camera.cameraOf(view, widthPx / heightPx), widthPx, heightPx };
}
