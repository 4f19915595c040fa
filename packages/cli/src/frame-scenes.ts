import { readdir, stat } from 'node:fs/promises';
import { join } from 'node:path';
import { type SplatFormatName, SplatSourceError } from '@websplatter/core';
import { formatByName } from '@websplatter/core/formats';
import { openFrames } from '@websplatter/core/frames';
import { describeSystemError, UsageError } from './input-error.ts';
import { findScene, isFrames, type SceneSource } from './scene-source.ts';

/**
 * The scenes of a file of frames, in order: each IN is a frame, a file of frames, or a folder of them.
 *
 * @param from see `SceneSource.format`.
 * @throws UsageError for a folder without scenes, or with scenes of several formats; the errors of
 *   `findScene`.
 */
export async function frameScenes(
  scenes: readonly string[],
  from: SplatFormatName | undefined,
): Promise<readonly SceneSource[]> {
  const found: SceneSource[] = [];
  for (const scene of scenes) {
    const names = await scenesOfFolder(scene);
    for (const name of names ?? [scene]) {
      const source = await findScene(name, from);
      if (isFrames(name, from)) for (const frame of await framesOf(source)) found.push(frame);
      else found.push(source);
    }
  }
  return found;
}

/** Paths of the scenes in a folder, numbers in their names by value; null if this is no folder. */
async function scenesOfFolder(folder: string): Promise<string[] | null> {
  const isFolder = await stat(folder).then(
    (found) => found.isDirectory(),
    // `findScene` reports a path that cannot be read.
    () => false,
  );
  if (!isFolder) return null;
  const entries = await readdir(folder, { withFileTypes: true }).catch((cause) => {
    throw new SplatSourceError(folder, `cannot be read: ${describeSystemError(cause)}`, undefined, { cause });
  });
  const names = entries.flatMap((entry) =>
    !entry.isDirectory() && formatByName(entry.name) ? entry.name : [],
  );
  const formats = [...new Set(names.map((name) => formatByName(name)!.name))];
  if (formats.length === 0)
    throw new UsageError(
      'IN',
      `IN is ${folder}, a folder without scenes; it must have a file for each frame`,
    );
  if (formats.length > 1) {
    const message = `IN is ${folder}, which has scenes of several formats, ${formats.join(', ')}; keep the frames of one`;
    throw new UsageError('IN', message);
  }
  return inFrameOrder(names).map((name) => join(folder, name));
}

/**
 * Names by the values of their numbers, as `inPathOrder` of @websplatter/three sorts files: `frame_-1`
 * comes before `frame_0`, `frame_2` before `frame_10`.
 */
function inFrameOrder(names: readonly string[]): string[] {
  const { compare } = new Intl.Collator('en', { numeric: true });
  // A hyphen is a minus after nothing, a slash or _, or after a text that numbers follow in other names.
  const stems = new Set(
    names.flatMap((name) => Array.from(name.matchAll(/\d+/g), ({ index }) => name.slice(0, index))),
  );
  const isMinusAfter = (text: string) => /(^|[/_])$/.test(text) || stems.has(text);
  // Punctuation comes before digits.
  const keyOf = (name: string) =>
    name.replace(/[-−](\d+)/g, (found, digits, at) =>
      isMinusAfter(name.slice(0, at)) ? `!${1e15 - digits}` : found,
    );
  return names.toSorted((a, b) => compare(keyOf(a), keyOf(b)));
}

async function framesOf({ source, name, limits, ...scene }: SceneSource): Promise<SceneSource[]> {
  const { frames } = await openFrames(source, { ...limits, name });
  return frames.map((frame) => ({ ...scene, limits, name: frame.name, source: frame, format: undefined }));
}

/** A note if the names of frames are in another order than the frames; undefined if they are in theirs. */
export function orderNote(scenes: readonly string[]): string | undefined {
  const ordered = inFrameOrder(scenes);
  const i = scenes.findIndex(
    (scene, index) => index > 0 && ordered.indexOf(scene) < ordered.indexOf(scenes[index - 1]),
  );
  if (i < 0) return undefined;
  return `${scenes[i]} comes after ${scenes[i - 1]}, as the command line has it; name the folder instead to sort frames by their numbers`;
}
