import { afterEach, expect, it, vi } from 'vitest';
import { oneSplat } from '../engine/one-splat.fixture.ts';
import type { InspectReply } from './inspect-messages.ts';
import type { SceneRequest } from './scene.worker.ts';

afterEach(() => vi.unstubAllGlobals());

it('answers about the scene that it was told to read before, however early it is asked', async () => {
  const replies: InspectReply[] = [];
  const worker = {
    onmessage: null as ((event: { data: SceneRequest }) => void) | null,
    postMessage: (reply: InspectReply) => replies.push(reply),
  };
  vi.stubGlobal('self', worker);
  await import('./scene.worker.ts');
  worker.onmessage?.({
    data: { kind: 'read', clouds: [{ source: { kind: 'set', set: oneSplat }, modelMatrix: null }] },
  });
  worker.onmessage?.({ data: { kind: 'ask', id: 1, about: 'splat', question: { cloudIndex: 0, row: 0 } } });
  worker.onmessage?.({ data: { kind: 'ask', id: 2, about: 'splat', question: { cloudIndex: 0, row: 5 } } });
  await expect.poll(() => replies.filter(({ kind }) => kind === 'answer').length).toBe(2);
  expect(replies).toContainEqual({ kind: 'read' });
  expect(replies).toContainEqual({ kind: 'answer', id: 1, answer: expect.objectContaining({ count: 1 }) });
  expect(replies).toContainEqual({ kind: 'answer', id: 2, answer: null });
  // A question without an answer is told.
  worker.onmessage?.({ data: { kind: 'ask', id: 3, about: 'splat', question: { cloudIndex: 9, row: 5 } } });
  await expect.poll(() => replies.at(-1)?.kind).toBe('failed');
});
