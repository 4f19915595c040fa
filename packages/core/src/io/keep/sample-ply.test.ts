import { expect, test } from 'vitest';
import { plyBytes, splatElement } from '../../testing/ply-fixture.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { encodePly } from '../formats/ply/write-ply.ts';
import { readSplats } from '../loading/read-splats.ts';
import { sampledRuns, samplePly } from './sample-ply.ts';

const set = randomSplats({ count: 1000, shDegree: 0 });
const file = new File([encodePly(set)], 'a.ply');

test('a sample has rows from all of the file, in their order, as many as were asked for', async () => {
  const sample = await samplePly(file, { splats: 600 });
  const { count, opacityLogits, logScales } = await readSplats(sample);
  expect(count).toBe(600);
  const row = (start: number, rows: number) => [...set.opacityLogits.subarray(start, start + rows)];
  expect([...opacityLogits]).toEqual([...row(0, 200), ...row(333, 200), ...row(666, 200)]);
  // They cover as much as all.
  for (let k = 0; k < 3; k++)
    expect(logScales[3 * 200 + k]).toBeCloseTo(set.logScales[3 * 333 + k] + Math.log(1000 / 600) / 2, 5);
  expect(await samplePly(file, { splats: 1000 })).toBe(file);
  await expect(samplePly(file, { splats: 0 })).rejects.toThrow('splats is 0');
});

test('a filter_3D of Mip-Splatting grows with the splats', async () => {
  const element = splatElement(1000, 0, (name) => (name.startsWith('scale') ? -3 : 0.5));
  const filter = { name: 'filter_3D', type: 'float', values: Array<number>(1000).fill(0.1) };
  const elements = [{ ...element, properties: [...element.properties, filter] }];
  const whole = new File([plyBytes({ format: 'binary_little_endian', elements })], 'a.ply');
  const [all, some] = await Promise.all(
    [whole, await samplePly(whole, { splats: 250 })].map((each) => readSplats(each)),
  );
  expect(some.logScales[0] - all.logScales[0]).toBeCloseTo(Math.log(2), 5);
  expect(some.opacityLogits[0]).toBeCloseTo(all.opacityLogits[0], 5);
});

test.each([
  [1e8, 200_000],
  [200_001, 200_000],
  [1000, 990],
  [2, 1],
])('of %i rows, %i are sampled in runs that do not overlap', (count, sampled) => {
  let [end, total] = [0, 0];
  for (const [first, rows] of sampledRuns(count, sampled)) {
    expect(first).toBeGreaterThanOrEqual(end);
    end = first + rows;
    total += rows;
  }
  expect(total).toBe(sampled);
  expect(end).toBeLessThanOrEqual(count);
});
