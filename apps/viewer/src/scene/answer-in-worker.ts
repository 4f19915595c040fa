import { readAgain } from '../engine/open/read-again.ts';
import type { Histograms } from '../state/inspecting.ts';
import type { CloudToRead, Question } from './inspect-messages.ts';
import { rowsWithin } from './rows-within.ts';
import {
  boundsInImage,
  histogramsOf,
  markColor,
  type ReadCloud,
  sampledCenters,
  splatInRow,
} from './scene-answers.ts';

/** This worker's scene. */
let clouds: readonly ReadCloud[] = [];
let histograms: Histograms | null = null;

/**
 * Reads the scene for `answer`.
 *
 * @param onProgress called with the fraction of the bytes read, 0…1; undefined if their number is
 *   unknown.
 */
export async function read(
  all: readonly CloudToRead[],
  onProgress: (part: number | undefined) => void,
): Promise<void> {
  const done: ReadCloud[] = [];
  for (const { source, modelMatrix } of all) {
    const part = (ofCloud: number | undefined) =>
      ofCloud === undefined ? undefined : (done.length + ofCloud) / all.length;
    const set = await readAgain(source, (ofCloud) => onProgress(part(ofCloud)));
    done.push({ set, modelMatrix });
  }
  clouds = done;
}

/**
 * Answers a question about the scene.
 *
 * @param onPart called with the fraction done, 0…1, where that takes long.
 */
export function answer({ about, question }: Question, onPart: (part: number) => void) {
  switch (about) {
    case 'splat':
      return splatInRow(clouds[question.cloudIndex], question.row);
    case 'histograms':
      return counted();
    case 'within':
      return rowsWithin(clouds, question.region, question.crop, counted, onPart);
    case 'sample':
      return sampledCenters(clouds, question.rows, question.most);
    case 'markColor':
      return markColor(clouds);
    case 'seen':
      return boundsInImage(clouds, question);
  }
}

function counted(): Histograms {
  histograms ??= histogramsOf(clouds);
  return histograms;
}
