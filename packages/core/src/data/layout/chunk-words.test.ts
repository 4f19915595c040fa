import { expect, it } from 'vitest';
import { CHUNK_WORDS } from './chunk-words.ts';
import { Chunk } from './structs.ts';

it('finds the fields where the GPU has them', () => {
  const bytes = { ...Chunk.offsets, count: Chunk.bytes };
  const words = Object.fromEntries(Object.entries(bytes).map(([field, at]) => [field, at / 4]));
  expect(words).toEqual(CHUNK_WORDS);
});
