/** Compares images off the main thread, so that the page stays responsive. */

import type { ImageOnBackground } from '../engine/drawn-frame.ts';
import { errorMap, judgePicture } from './error-map.ts';

export type ErrorMapRequest =
  /** Requests an error map. */
  | { readonly kind: 'map'; readonly actual: ImageOnBackground; readonly reference: ImageOnBackground }
  /** Requests a comparison with the reference, which is the image of the first such request. */
  | { readonly kind: 'judge'; readonly actual: ImageOnBackground };

let firstJudged: ImageOnBackground | undefined;

self.onmessage = ({ data: request }: MessageEvent<ErrorMapRequest>) => {
  if (request.kind === 'map') {
    const map = errorMap(request.actual, request.reference);
    self.postMessage(map, { transfer: [map.data.buffer] });
  } else {
    firstJudged ??= request.actual;
    const judged = judgePicture(request.actual, firstJudged);
    self.postMessage(judged, { transfer: [judged.whole.data.buffer] });
  }
};
