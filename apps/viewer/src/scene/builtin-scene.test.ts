import { resolveAccuracy } from '@websplatter/core';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { foreseeBuiltinScene, makeBuiltinScene } from './builtin-scene.ts';
import type { MadeScene, SceneRequest } from './builtin-scene.worker.ts';

class TestWorker {
  readonly requests: SceneRequest[] = [];
  isTerminated = false;
  onmessage: ((event: { data: MadeScene }) => void) | null = null;
  onerror: ((event: { message: string }) => void) | null = null;

  constructor() {
    workers.push(this);
  }

  postMessage(request: SceneRequest): void {
    this.requests.push(request);
  }

  terminate(): void {
    this.isTerminated = true;
  }

  answer(name: string): void {
    this.onmessage?.({ data: { name } as MadeScene });
  }
}

let workers: TestWorker[];
beforeEach(() => {
  workers = [];
  vi.stubGlobal('Worker', TestWorker);
});
afterEach(() => vi.unstubAllGlobals());

const accuracy = resolveAccuracy('fast');
const packing = { geometryPrecision: accuracy.geometryPrecision, shPrecision: accuracy.shPrecision };

function make(name: string, signal = new AbortController().signal) {
  const drafts: string[] = [];
  const made = makeBuiltinScene(name, accuracy, signal, (draft) => drafts.push(draft.name));
  return { made, drafts };
}

it('shows a draft of a scene that takes long, and ends its worker with the scene', async () => {
  const { made, drafts } = make('still-life');
  const [worker] = workers;
  expect(worker.requests).toEqual([
    { name: 'still-life-small', packing },
    { name: 'still-life', packing },
  ]);
  worker.answer('still-life-small');
  expect(drafts).toEqual(['still-life-small']);
  expect(worker.isTerminated).toBe(false);
  worker.answer('still-life');
  expect((await made).name).toBe('still-life');
  expect(drafts).toHaveLength(1);
  expect(worker.isTerminated).toBe(true);
});

it('has no draft of the small scene', async () => {
  const { made, drafts } = make('still-life-small');
  workers[0].answer('still-life-small');
  expect((await made).name).toBe('still-life-small');
  expect(drafts).toEqual([]);
});

it('goes on with the worker that has foreseen the scene, once', async () => {
  foreseeBuiltinScene('still-life');
  expect(workers[0].requests).toEqual([{ name: 'still-life-small' }]);
  make('still-life-small').made.catch(() => {});
  expect(workers).toHaveLength(1);
  expect(workers[0].requests).toHaveLength(2);
  make('still-life-small').made.catch(() => {});
  expect(workers).toHaveLength(2);
});

it('fails where the draft cannot be shown, and where the worker fails', async () => {
  const made = makeBuiltinScene('still-life', accuracy, new AbortController().signal, () => {
    throw new Error('no memory');
  });
  workers[0].answer('still-life-small');
  await expect(made).rejects.toThrow('no memory');
  expect(workers[0].isTerminated).toBe(true);
  const other = make('still-life').made;
  workers[1].onerror?.({ message: '' });
  await expect(other).rejects.toThrow('could not be started');
});

it('ends at once when it is called off', async () => {
  const controller = new AbortController();
  const { made } = make('still-life', controller.signal);
  controller.abort(new Error('called off'));
  await expect(made).rejects.toThrow('called off');
  expect(workers[0].isTerminated).toBe(true);
});
