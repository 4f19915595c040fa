/** Draws cases in float64, off the main thread, so that the page stays responsive. */

import { HARD_CASES, type HardCloud } from '@websplatter/conformance';
import { type Harmonics, readSplats, type SplatSet } from '@websplatter/core';
import { renderReference } from '@websplatter/core/reference';
import { serve } from '@websplatter/core/write';

export interface ExpectedRequest {
  /** Name of the case. */
  readonly name: string;
  /** Name of one of the case's cameras. */
  readonly cameraName: string;
  readonly widthPx: number;
  readonly heightPx: number;
}

/** Premultiplied RGBA, top row first. */
export type ExpectedImage = ArrayLike<number>;

async function draw({ name, cameraName, widthPx, heightPx }: ExpectedRequest): Promise<ExpectedImage> {
  const hardCase = HARD_CASES.find((candidate) => candidate.name === name);
  if (hardCase?.kind !== 'scene' && hardCase?.kind !== 'device')
    throw new RangeError(`There is no hard case “${name}” with an image.`);
  const camera = hardCase.cameras(widthPx / heightPx)[cameraName];
  if (!camera) throw new RangeError(`The hard case “${name}” has no camera “${cameraName}”.`);
  const clouds = await Promise.all(hardCase.clouds().map(placedSet));
  return renderReference({ clouds, camera, widthPx, heightPx }).data;
}

async function placedSet(
  cloud: HardCloud,
): Promise<{ readonly set: SplatSet<Harmonics>; readonly modelMatrix?: ArrayLike<number> }> {
  const set = 'set' in cloud ? cloud.set : await readSplats(cloud.file, { shPrecision: 'f32' });
  return { set, modelMatrix: cloud.modelMatrix };
}

const TASKS = { draw };

export type ExpectedTasks = typeof TASKS;

serve(TASKS);
