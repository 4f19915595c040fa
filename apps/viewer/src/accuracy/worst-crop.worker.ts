/** Compares pictures off the main thread, so that the page stays responsive. */

import type { ImageOnBackground } from '../engine/drawn-frame.ts';
import { judgePicture } from './worst-crop.ts';

let reference: ImageOnBackground;

/** The first image is the reference, all others are judged. */
self.onmessage = ({ data }: MessageEvent<ImageOnBackground>) => {
  reference ??= data;
  const judged = judgePicture(data, reference);
  self.postMessage(judged, { transfer: [judged.whole.data.buffer] });
};
