/** Compares images off the main thread, so that the page stays responsive. */

import type { ImageOnBackground } from '../engine/drawn-frame.ts';
import { errorMap } from './error-map.ts';

export interface ErrorMapRequest {
  readonly actual: ImageOnBackground;
  readonly reference: ImageOnBackground;
}

self.onmessage = ({ data }: MessageEvent<ErrorMapRequest>) => {
  const map = errorMap(data.actual, data.reference);
  self.postMessage(map, { transfer: [map.data.buffer] });
};
