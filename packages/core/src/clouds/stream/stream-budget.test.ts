import { expect, test } from 'vitest';
import { nextTask } from '../../data/turns.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import { signalOf } from '../../testing/signal.ts';
import { type StreamShares, sharesOf, withShare } from './stream-budget.ts';

const sharesWith = (budgetBytes: number): StreamShares => ({
  budgetBytes,
  sharers: new Set(),
  turn: Promise.resolve(),
});
const need = (name: string, leastBytes: number, mostBytes: number) => ({ name, leastBytes, mostBytes });

test('equal shares, within what each scene can use, take the budget and no more', () => {
  const shares = (...needs: (readonly [number, number])[]) =>
    sharesOf(
      needs.map(([least, most]) => need('a', least, most)),
      100,
    );
  expect(shares([1, 300])).toEqual([100]);
  expect(shares([1, 300], [1, 300])).toEqual([50, 50]);
  expect(shares([1, 300], [1, 20])).toEqual([80, 20]);
  expect(shares([1, 300], [70, 300])).toEqual([30, 70]);
  expect(shares([1, 300], [1, 300], [60, 300], [0, 10])).toEqual([15, 15, 60, 10]);
  expect(shares()).toEqual([]);
  expect(sharesOf([need('a', 1, 300)], Number.POSITIVE_INFINITY)).toEqual([300]);
  const random = seededRandom(3);
  for (let run = 0; run < 100; run++) {
    const needs = Array.from({ length: 1 + Math.floor(6 * random()) }, () => {
      const least = Math.floor(1e6 * random());
      return need('a', least, least + Math.floor(1e9 * random()));
    });
    const budget = needs.reduce((sum, { leastBytes }) => sum + leastBytes, Math.floor(2e9 * random()));
    const found = sharesOf(needs, budget);
    const total = found.reduce((sum, bytes) => sum + bytes, 0);
    const most = needs.reduce((sum, { mostBytes }) => sum + mostBytes, 0);
    expect(total).toBeLessThanOrEqual(budget);
    expect(total).toBeGreaterThan(Math.min(budget, most) - needs.length - 1);
    for (const [i, { leastBytes, mostBytes }] of needs.entries()) {
      expect(found[i]).toBeGreaterThanOrEqual(leastBytes);
      expect(found[i]).toBeLessThanOrEqual(mostBytes);
    }
  }
});

/** Makes scenes that record each change of what they hold. */
function scenesOf(shares: StreamShares) {
  const held = new Map<string, number>();
  const totals: number[] = [];
  const hold = (name: string, bytes: number) => {
    held.set(name, bytes);
    totals.push([...held.values()].reduce((sum, each) => sum + each, 0));
  };
  const leaving = new Map<string, () => void>();
  const add = (
    name: string,
    least: number,
    most: number,
    { begin = async () => {}, signal = undefined as AbortSignal | undefined } = {},
  ) =>
    withShare(shares, need(name, least, most), { signal }, async (bytes, leave) => {
      await begin();
      hold(name, bytes);
      leaving.set(name, () => {
        held.delete(name);
        leave();
      });
      return {
        made: name,
        resize: async (changed) => {
          await nextTask();
          hold(name, changed);
        },
      };
    });
  return { held, totals, add, remove: (name: string) => leaving.get(name)!() };
}

test('scenes make room before another comes, and get back what it leaves', async () => {
  const shares = sharesWith(90);
  const { held, totals, add, remove } = scenesOf(shares);
  await add('a', 10, 1000);
  await Promise.all([add('b', 10, 1000), add('c', 10, 20)]);
  expect(Object.fromEntries(held)).toEqual({ a: 35, b: 35, c: 20 });
  remove('a');
  await shares.turn;
  expect(Object.fromEntries(held)).toEqual({ b: 70, c: 20 });
  expect(Math.max(...totals)).toBe(90);
  const own = withShare(shares, need('d', 10, 1000), { budgetBytes: 500 }, async (made) => ({
    made,
    resize: null,
  }));
  expect(await own).toBe(500);
  expect(held.get('b')).toBe(70);
});

test('what cannot come, or is called off, leaves the others as they were', async () => {
  const shares = sharesWith(90);
  const { held, add, remove } = scenesOf(shares);
  await add('a', 50, 1000);
  await expect(add('b', 50, 1000)).rejects.toThrow(
    /streamBudgetBytes is 90; b and 1 that are there need .* 100/,
  );
  await expect(add('b', 10, 1000, { begin: () => Promise.reject(new Error('gone')) })).rejects.toThrow(
    'gone',
  );
  const { when, give } = signalOf();
  const ending = new AbortController();
  const first = add('c', 10, 1000, { begin: () => when });
  const second = add('d', 10, 1000, { signal: ending.signal });
  ending.abort(new Error('enough'));
  give();
  expect(await first).toBe('c');
  await expect(second).rejects.toThrow('enough');
  remove('c');
  remove('c');
  await shares.turn;
  expect(Object.fromEntries(held)).toEqual({ a: 90 });
});
