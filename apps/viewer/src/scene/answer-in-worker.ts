import { readAgain } from '../engine/read-again.ts';
import type { Histograms } from '../state/inspecting.ts';
import type { AskRequest, CloudToRead, InspectReply, InspectRequest } from './inspect-messages.ts';
import { rowsWithin } from './rows-within.ts';
import { boundsInImage, cropCount, histogramsOf, type ReadCloud, splatInRow } from './scene-answers.ts';

type Reply = (message: InspectReply) => void;

/** This worker's scene, which is read once and then answers questions. */
let reading: Promise<readonly ReadCloud[]> = Promise.resolve([]);
let histograms: Histograms | null = null;

/**
 * Reads a scene or answers a question about the last one. Replies with every outcome and never
 * throws.
 */
export async function answer(request: InspectRequest, reply: Reply): Promise<void> {
  try {
    if (request.kind === 'read') {
      reading = read(request.clouds, reply);
      await reading;
      reply({ kind: 'read' });
    } else reply({ kind: 'answer', id: request.id, answer: answerOf(await reading, request) });
  } catch (error) {
    reply({ kind: 'failed', message: error instanceof Error ? error.message : String(error) });
  }
}

async function read(clouds: readonly CloudToRead[], reply: Reply): Promise<readonly ReadCloud[]> {
  const done: ReadCloud[] = [];
  for (const { source, modelMatrix } of clouds) {
    const part = (ofCloud: number | undefined) =>
      ofCloud === undefined ? undefined : (done.length + ofCloud) / clouds.length;
    const set = await readAgain(source, (ofCloud) => reply({ kind: 'progress', part: part(ofCloud) }));
    done.push({ set, modelMatrix });
  }
  return done;
}

function answerOf(clouds: readonly ReadCloud[], request: AskRequest) {
  switch (request.about) {
    case 'splat': {
      const { cloudIndex, row } = request.question;
      return splatInRow(clouds[cloudIndex], row);
    }
    case 'histograms':
      return counted(clouds);
    case 'within': {
      const { region, crop } = request.question;
      return rowsWithin(clouds, region, crop, () => counted(clouds));
    }
    case 'count':
      return cropCount(clouds, request.question);
    case 'seen':
      return boundsInImage(clouds, request.question);
  }
}

function counted(clouds: readonly ReadCloud[]): Histograms {
  histograms ??= histogramsOf(clouds);
  return histograms;
}
