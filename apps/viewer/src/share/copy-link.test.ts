import { expect, test } from 'vitest';
import { NOTHING_INSPECTED } from '../state/inspecting.ts';
import { copied } from './copy-link.ts';

const ruler = {
  id: 1,
  ends: [
    [0, 0, 0],
    [1, 0, 0],
  ],
} as const;

test('a copied link promises only what it carries', () => {
  const words = (bits: number, rulers: readonly (typeof ruler)[] = []) => {
    const removed = new Map(bits === 0 ? [] : [['1/0', Uint32Array.of(bits)]]);
    const selecting = { ...NOTHING_INSPECTED.selecting, removed };
    return copied({ inspecting: { ...NOTHING_INSPECTED, rulers, selecting } });
  };
  expect(words(0)).toBe('The link is copied: it shows this picture in a window of the same size.');
  expect(words(0xffffffff)).toBe(
    'The link is copied: it shows this view without your 32 removals. Save a web page to share it as you see it.',
  );
  expect(words(0, [ruler])).toBe('The link is copied: it shows this view without your 1 ruler.');
  expect(words(1, [ruler, ruler])).toContain('without your 1 removal and 2 rulers. Save');
});
