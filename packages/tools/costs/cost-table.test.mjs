import { expect, test } from 'vitest';
import { costsOf, costTable } from './cost-table.mjs';

const at = (totalMs, compileMs = 0, drawMs = 0, browserGpuMs = 0) => ({
  totalMs,
  compileMs,
  drawMs,
  browserGpuMs,
});
const LINES = [
  { project: 'unit', file: 'a.test.ts', test: 'first', begun: at(5000), ended: at(5200) },
  { project: 'unit', file: 'a.test.ts', test: 'second', begun: at(5200), ended: at(5600) },
  { project: 'gpu', file: 'b.gpu.test.ts', test: 'draws', begun: at(7600), ended: at(9600, 1500, 300) },
  // A browser that ended took its processes' time with it.
  { project: 'smoke', file: 'c.test.ts', test: 'a page', begun: at(9500), ended: at(10_100, 1500, 300, 400) },
];

test('what is spent between two tests is the set-up of the later one', () => {
  const { startS, files, tests } = costsOf(LINES);
  expect(startS).toBe(5);
  expect(files).toEqual([
    {
      project: 'gpu',
      file: 'b.gpu.test.ts',
      tests: 1,
      total: 4,
      setUp: 2,
      compile: 1.5,
      draw: 0.3,
      browserGpu: 0,
    },
    expect.objectContaining({ file: 'a.test.ts', tests: 2, setUp: 0, total: expect.closeTo(0.6) }),
    expect.objectContaining({ file: 'c.test.ts', setUp: 0, total: 0.6, browserGpu: 0.4 }),
  ]);
  expect(tests.map(({ test }) => test)).toEqual(['draws', 'a page', 'second', 'first']);
});

test('the table begins with the sum, and lists projects, files and tests, the dearest first', () => {
  const table = costTable(costsOf(LINES));
  expect(table).toMatch(/^CPU seconds.*: 10, of which 5 before the first test\./);
  const names = ['gpu\n', 'gpu b.gpu.test.ts', 'unit a.test.ts', 'smoke c.test.ts', '> draws', '> second'];
  const places = names.map((name) => table.indexOf(name));
  expect(Math.min(...places)).toBeGreaterThan(0);
  expect(places).toEqual(places.toSorted((a, b) => a - b));
});
