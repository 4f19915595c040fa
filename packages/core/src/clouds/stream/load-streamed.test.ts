import { expect, test } from 'vitest';
import { knownSource } from '../../io/sources/known-source.ts';
import type { SourceOptions, SplatSource } from '../../io/sources/splat-source.ts';
import { loadStreamed } from './load-streamed.ts';
import type { StreamContext } from './stream-budget.ts';

test('a scene streams if its address, its file or the options name it so', async () => {
  const context = { pipelines: { prepare: async () => {} } } as unknown as StreamContext;
  const signal = AbortSignal.abort('stop');
  const load = (source: SplatSource, options: SourceOptions = {}) =>
    loadStreamed(context, knownSource(source, options), { ...options, signal }, {});
  expect(load('https://example.org/a.ply')).toBeNull();
  expect(load(new File([], 'a.ply'))).toBeNull();
  await expect(load('https://example.org/a.bricks?b')).rejects.toBe('stop');
  await expect(load(new File([], 'a.bricks'))).rejects.toBe('stop');
  await expect(load('https://example.org/a', { name: 'a.bricks' })).rejects.toBe('stop');
  await expect(load('https://example.org/a', { format: 'bricks' })).rejects.toBe('stop');
});
