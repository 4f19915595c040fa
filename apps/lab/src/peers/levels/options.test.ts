import { expect, test } from 'vitest';
import { BenchError } from '../runner/bench-error.ts';
import { readOptions } from './options.ts';

test('the options of the bench of levels have defaults', () => {
  expect(readOptions(['--scene', 'garden.ply'], '/here')).toEqual({
    scenes: ['/here/garden.ply'],
    synthetic: [],
    shares: [0.5, 0.25, 0.12, 0.06],
    views: 4,
    isFlat: false,
    evidenceFile: null,
  });
});

test.each([
  [[], 'Give --scene or --synthetic.'],
  [['--scene', 'a.ply', '--synthetic', '10000'], 'Give --scene or --synthetic.'],
  [['--synthetic', '10000', '--shares', '50,x'], '--shares has "x"; it takes whole numbers from 1 on.'],
])('%j are refused', (args, message) => {
  expect(() => readOptions(args, '/here')).toThrow(new BenchError(message));
});
