import { expect, it } from 'vitest';
import { noticeWith } from './messages.ts';

it('all that is wrong at once is said, with all that is on offer', () => {
  expect(noticeWith(null, 'No such scene.')).toBe('No such scene.');
  const flip = { label: 'Flip', command: 'flip' } as const;
  const both = noticeWith('No such scene.', { text: 'It stands on its head.', offers: [flip] });
  expect(noticeWith(both, 'No such camera.')).toEqual({
    text: 'No such scene. It stands on its head. No such camera.',
    offers: [flip],
  });
});
