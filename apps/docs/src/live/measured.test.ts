import { expect, it } from 'vitest';
import { measuredText } from './measured.ts';

it('writes a measurement as a table to paste, the adapter first', () => {
  const text = measuredText({
    facts: ['Some GPU', '1280 × 720'],
    columns: ['Stage', 'median ms'],
    rows: [['Sort', '0.120']],
    notes: ['Times are rough.'],
  });
  expect(text).toBe(
    'Some GPU · 1280 × 720\n\n| Stage | median ms |\n| --- | ---: |\n| Sort | 0.120 |\n\nNote: Times are rough.\n',
  );
});
