import { describe, expect, test } from 'vitest';
import { type SampledCount, shareSamples } from './samples.ts';

/** Chosen places of each cloud, as text. */
function places(clouds: readonly SampledCount[], most: number): string[][] {
  const { chosen } = shareSamples(clouds, most);
  return chosen.map(({ splats, instances }) => Array.from(splats, (splat, i) => `${splat}@${instances[i]}`));
}

describe('samples', () => {
  test('are all splats of all instances, if there are no more', () => {
    const clouds = [
      { splats: 5, instances: 1 },
      { splats: 0, instances: 4 },
      { splats: 7, instances: 3 },
    ];
    const chosen = places(clouds, 26);
    expect(chosen.map(({ length }) => length)).toEqual([5, 0, 21]);
    for (const each of chosen) expect(new Set(each).size).toBe(each.length);
    expect(shareSamples(clouds, 26).weight).toBe(1);
  });

  test('are shared out by numbers of splats, ascending', () => {
    const clouds = [
      { splats: 30_000, instances: 1 },
      { splats: 10_000, instances: 6 },
      { splats: 10_000, instances: 1 },
    ];
    const { chosen, weight } = shareSamples(clouds, 1000);
    expect(chosen.map(({ splats }) => splats.length)).toEqual([300, 600, 100]);
    expect(weight).toBe(100);
    for (const { splats } of chosen) expect(splats).toEqual(splats.toSorted());
    expect([...chosen[0].splats.slice(0, 3)]).toEqual([0, 100, 200]);
  });

  test.each([
    { splats: 1000, instances: 100_000 },
    { splats: 65_536, instances: 4096 },
    { splats: 100_000, instances: 64 },
    { splats: 3, instances: 1_000_000 },
  ])('of $instances instances of $splats splats are spread over both', (cloud) => {
    const most = 4096;
    const { splats, instances } = shareSamples([cloud], most).chosen[0];
    for (const [values, range] of [
      [splats, cloud.splats],
      [instances, cloud.instances],
    ] as const) {
      const bins = new Uint32Array(Math.min(3, range));
      for (const value of values) bins[Math.floor((value / range) * bins.length)]++;
      for (const bin of bins) expect(bin).toBeGreaterThan((0.8 * most) / bins.length);
    }
  });

  test('of nothing are none', () => {
    expect(shareSamples([], 10)).toEqual({ chosen: [], weight: 1 });
    expect(shareSamples([{ splats: 0, instances: 1 }], 10).chosen[0].splats).toHaveLength(0);
  });
});
