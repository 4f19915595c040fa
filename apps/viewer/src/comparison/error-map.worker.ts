/** Compares pictures off the main thread, so that the page stays responsive. */

import type { PictureOnBackground } from '../viewer/viewer.ts';
import { errorMap } from './error-map.ts';

export interface ErrorMapRequest {
  readonly actual: PictureOnBackground;
  readonly reference: PictureOnBackground;
}

self.onmessage = ({ data }: MessageEvent<ErrorMapRequest>) => {
  const map = errorMap(data.actual, data.reference);
  self.postMessage(map, { transfer: [map.data.buffer] });
};
