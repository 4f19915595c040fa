/**
 * Reads a scene again, off the main thread, and writes it as a file or answers questions about its
 * splats. All tasks share a script, so that the readers of all formats are downloaded once.
 * Terminating the worker cancels all work.
 */
import { serve } from '@websplatter/core/write';
import type { CloudToRead, Question } from './inspect-messages.ts';
import type { CutRequest, OnSaving, SaveRequest } from './write-scene.ts';

const TASKS = {
  /** Resolves with the file, and with a sentence for each kind of data that its format cannot store. */
  save: async (request: SaveRequest, _: unknown, onProgress: OnSaving) => {
    const { writeScene } = await import('./write-scene.ts');
    const notes: string[] = [];
    const bytes = await writeScene(request, onProgress, (note) => notes.push(note));
    return { bytes, notes };
  },
  cut: async (request: CutRequest, _: unknown, onProgress: OnSaving) => {
    const { cutFile } = await import('./write-scene.ts');
    return cutFile(request, onProgress);
  },
  /** Reads a scene for `ask`. */
  read: async (
    clouds: readonly CloudToRead[],
    _: unknown,
    onProgress: (part: number | undefined) => void,
  ) => {
    const { read } = await import('./answer-in-worker.ts');
    await read(clouds, onProgress);
  },
  ask: async (question: Question, _: unknown, onPart: (part: number) => void) => {
    const { answer } = await import('./answer-in-worker.ts');
    return answer(question, onPart);
  },
};

export type SceneWorkerTasks = typeof TASKS;

serve(TASKS);
