import { afterEach, expect, it, vi } from 'vitest';
import { oneSplat } from '../engine/open/one-splat.fixture.ts';

afterEach(() => vi.unstubAllGlobals());

it('answers about the scene that it was told to read before, however early it is asked', async () => {
  const replies: { readonly kind: string; readonly id: number }[] = [];
  const worker = {
    onmessage: null as ((event: { data: object }) => void) | null,
    postMessage: (reply: (typeof replies)[number]) => replies.push(reply),
  };
  vi.stubGlobal('self', worker);
  await import('./scene.worker.ts');
  const post = (task: string, id: number, input: unknown) =>
    worker.onmessage?.({ data: { task, id, input } });
  const askSplat = (id: number, cloudIndex: number, row: number) =>
    post('ask', id, { about: 'splat', question: { cloudIndex, row } });
  post('read', 1, [{ source: { kind: 'set', set: oneSplat }, modelMatrix: null }]);
  askSplat(2, 0, 0);
  askSplat(3, 0, 5);
  await expect.poll(() => replies.at(-1)?.id).toBe(3);
  expect(replies).toContainEqual({ kind: 'done', id: 1, result: undefined });
  expect(replies).toContainEqual({ kind: 'done', id: 2, result: expect.objectContaining({ count: 1 }) });
  expect(replies).toContainEqual({ kind: 'done', id: 3, result: null });
  // A question without an answer is told.
  askSplat(4, 9, 5);
  await expect.poll(() => replies.at(-1)).toMatchObject({ kind: 'error', id: 4 });
});
