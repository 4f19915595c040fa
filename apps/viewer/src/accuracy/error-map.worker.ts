/** Compares images off the main thread, so that the page stays responsive. */

import { serve } from '@websplatter/core/write';
import type { ImageOnBackground } from '../engine/viewer.ts';
import { errorMap, judgePicture } from './error-map.ts';

let firstJudged: ImageOnBackground | undefined;

const TASKS = {
  map: ({
    actual,
    reference,
  }: {
    readonly actual: ImageOnBackground;
    readonly reference: ImageOnBackground;
  }) => errorMap(actual, reference),
  /** Compares with the reference, which is the first image judged. */
  judge: (actual: ImageOnBackground) => {
    firstJudged ??= actual;
    return judgePicture(actual, firstJudged);
  },
};

export type ErrorMapTasks = typeof TASKS;

serve(TASKS);
