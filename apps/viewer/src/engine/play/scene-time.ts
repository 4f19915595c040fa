import type { SplatCloud, TimeRange } from '@websplatter/core';
import type { ShownScene } from '../open/shown-scene.ts';

/** Files of moving splats do not say how long they last: most are captures of two to ten seconds. */
const LOOP_MS = 5000;

/** The times of a scene that moves. */
export interface SceneTiming {
  /** First and last time of its moving files. */
  readonly range: TimeRange;
  /** Frames per second of files of frames, the most of any, whose times are seconds; null without any. */
  readonly framesPerS: number | null;
}

/** Frames of the cloud's file; null if it has no more than one. */
export function framesOf({ facts }: SplatCloud) {
  const frames = facts.fileFacts?.frames;
  return frames && frames.count > 1 ? frames : null;
}

/** Null for a scene that stands still. */
export function timingOf(scene: Pick<ShownScene, 'parts'> | null): SceneTiming | null {
  const clouds = (scene?.parts ?? []).flatMap(({ loaded }) => loaded.clouds.map(({ cloud }) => cloud));
  const frames = clouds.flatMap((cloud) => framesOf(cloud) ?? []);
  const ranges = [
    ...clouds.flatMap(({ timeRange }) => (timeRange ? [timeRange] : [])),
    ...frames.map(({ count, perS }) => [0, count / perS] as const),
  ];
  if (ranges.length === 0) return null;
  const range = [Math.min(...ranges.map(([from]) => from)), Math.max(...ranges.map(([, to]) => to))] as const;
  return { range, framesPerS: frames.length > 0 ? Math.max(...frames.map(({ perS }) => perS)) : null };
}

/** Time of a playing scene `elapsedMs` after `from`; after its end it begins anew. */
export function timeAfter({ range, framesPerS }: SceneTiming, from: number, elapsedMs: number): number {
  const [first, last] = range;
  const length = last - first;
  const part = (from - first) / length + elapsedMs / (framesPerS ? 1000 * length : LOOP_MS);
  return first + length * (part - Math.floor(part));
}
