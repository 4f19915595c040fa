import { expect, test } from 'vitest';
import { describeEdits } from './describe-edits.ts';
import { NOTHING_INSPECTED } from './inspecting.ts';

const crop = { min: [0, 0, 0], max: [1, 1, 1], keep: 'inside' } as const;
const ruler = {
  id: 1,
  ends: [
    [0, 0, 0],
    [1, 0, 0],
  ],
} as const;
const removing = (bits: number) => ({
  selecting: { ...NOTHING_INSPECTED.selecting, removed: new Map([['1/0', Uint32Array.of(bits)]]) },
});

test('edits that no file has are told in words', () => {
  const words = (change: object) => describeEdits({ ...NOTHING_INSPECTED, ...change });
  expect(words({})).toBe('');
  expect(words({ crop })).toBe('a crop');
  expect(words({ rulers: [ruler], ...removing(1) })).toBe('1 removed splat and 1 ruler');
  expect(words({ crop, rulers: [ruler, ruler], ...removing(7) })).toBe(
    'a crop, 3 removed splats, and 2 rulers',
  );
});
