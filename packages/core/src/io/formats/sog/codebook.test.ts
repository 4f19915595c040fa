import { expect, test } from 'vitest';
import { Turns } from '../../../data/turns.ts';
import { seededRandom } from '../../../testing/seeded-random.ts';
import { findCodebook } from './codebook.ts';

const find = (values: Float32Array) => findCodebook(values.slice(), new Turns(undefined));
const random = seededRandom(3);

test.each([1, 2, 255, 256])('%i different values are kept', async (count) => {
  const different = Float32Array.from({ length: count }, () => 2000 * random() - 1000);
  const values = Float32Array.from({ length: 3 * count }, (_, i) => different[i % count]);
  const codebook = await find(values);
  expect(codebook.values.length).toBe(256);
  for (const value of values) expect(codebook.values[codebook.nearest(value)]).toBe(value);
});

test('each value is told by the nearest of ascending ones', async () => {
  const values = Float32Array.from({ length: 3000 }, () => Math.tan(3 * random()));
  const { values: found } = await find(values);
  const codebook = await find(values);
  expect([...found].sort((a, b) => a - b)).toEqual([...found]);
  for (const value of values) {
    const least = Math.min(...found.map((each) => Math.abs(each - value)));
    expect(Math.abs(found[codebook.nearest(value)] - value)).toBe(least);
  }
});

test('values of a normal distribution have no larger an error than the best 256 can have', async () => {
  const normal = () => Math.sqrt(-2 * Math.log(1 - random())) * Math.cos(2 * Math.PI * random());
  const values = Float32Array.from({ length: 30_000 }, normal);
  const codebook = await find(values);
  const squares = values.reduce((sum, x) => sum + (codebook.values[codebook.nearest(x)] - x) ** 2, 0);
  // Panter and Dite: π√3 / (2·256²) times the variance for many values.
  expect(squares / values.length).toBeLessThan((1.05 * (Math.PI * Math.sqrt(3))) / (2 * 256 ** 2));
});

test('one value far off does not take the others’ precision', async () => {
  const values = Float32Array.from({ length: 3000 }, () => random());
  values[77] = -1e30;
  const codebook = await find(values);
  const errors = values.map((value) => Math.abs(codebook.values[codebook.nearest(value)] - value));
  expect(errors[77]).toBe(0);
  expect(Math.max(...errors)).toBeLessThan(0.05);
});
