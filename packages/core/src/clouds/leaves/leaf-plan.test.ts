import { describe, expect, it } from 'vitest';
import type { LeafLevel, SceneLeaf } from '../../data/bricks/leaf-scene.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import type { CloudSight } from '../stream/cloud-sight.ts';
import { planLeaves } from './leaf-plan.ts';

const random = seededRandom(3);

/** Leaves along x, a unit apart, whose levels have a quarter of the splats each. */
function leavesOf(leafCount: number, levelCount = 3): SceneLeaf[] {
  return Array.from({ length: leafCount }, (_, i) => ({
    bounds: { min: [i, 0, 0], max: [i + 1, 1, 1] },
    levels: Array.from(
      { length: levelCount },
      (_, level): LeafLevel => ({
        file: level,
        count: 1024 * 4 ** (levelCount - 1 - level),
        chunkCount: 4 ** (levelCount - level),
        error: level === 0 ? 0 : 0.01 * 2 ** level,
      }),
    ),
  }));
}

const anything = 1e9;
const sightFrom = (x: number, allowedAtUnit: number, others: Partial<CloudSight> = {}): CloudSight => ({
  cut: {
    camera: [x, 0.5, 0.5],
    squaredPerDistance: allowedAtUnit ** 2,
    leastSquared: (0.01 * allowedAtUnit) ** 2,
    margin: 0,
  },
  squaredShift: 1,
  sides: [],
  ...others,
});
const targetsOf = (leaves: SceneLeaf[], sights: CloudSight[], room = anything) =>
  planLeaves(leaves, sights, room).map(({ target }) => target);

describe('the plan of leaves', () => {
  it('wants the coarsest level whose error a view allows where the leaf is nearest', () => {
    const leaves = leavesOf(12);
    const plan = planLeaves(leaves, [sightFrom(0.5, 0.005)], anything);
    for (const [i, { wanted, target }] of plan.entries()) {
      const allowed = 0.005 * Math.max(0.01, i - 0.5);
      const expected = leaves[i].levels.findLastIndex(({ error }) => error <= allowed);
      expect([wanted, target]).toEqual([expected, expected]);
    }
    expect(new Set(plan.map(({ target }) => target))).toEqual(new Set([0, 1, 2]));
    expect(targetsOf(leaves, [])).toEqual(leaves.map(() => 2));
  });

  it('refines first where the error exceeds most what is allowed, level by level, as far as there is room', () => {
    const leaves = leavesOf(8);
    const sights = [sightFrom(-1, 1e-4)];
    let before = targetsOf(leaves, sights, 0);
    expect(before).toEqual(leaves.map(() => 2));
    for (let room = 8; room < 700; room += 8) {
      const targets = targetsOf(leaves, sights, room);
      const chunks = (each: readonly number[]) =>
        each.reduce((sum, level, i) => sum + (level === 2 ? 0 : leaves[i].levels[level].count / 256), 0);
      expect(chunks(targets)).toBeLessThanOrEqual(room);
      expect(chunks(targets)).toBeGreaterThanOrEqual(chunks(before));
      before = targets;
    }
    expect(before).toEqual(leaves.map(() => 0));
    // Room for one leaf of the middle level, and then for one of the finest.
    expect(targetsOf(leaves, sights, 16)).toEqual([1, 2, 2, 2, 2, 2, 2, 2]);
    expect(targetsOf(leaves, sights, 64)[0]).toBeLessThan(2);
  });

  it('takes what all views want together, the most demanding for each leaf', () => {
    const leaves = leavesOf(20);
    const [near, far] = [sightFrom(0, 0.004), sightFrom(20, 0.008)];
    const both = targetsOf(leaves, [near, far]);
    const one = targetsOf(leaves, [near]);
    const other = targetsOf(leaves, [far]);
    expect(both).toEqual(one.map((level, i) => Math.min(level, other[i])));
    expect(both).toEqual(targetsOf(leaves, [far, near]));
  });

  it('gives what is out of sight room last, and does not want it for its own sake', () => {
    const leaves = leavesOf(6);
    const behind = { normal: [1, 0, 0] as const, offset: -8, reach: 0 };
    const hidden = planLeaves(leaves, [sightFrom(3, 1e-4, { sides: [behind] })], anything);
    expect(hidden.every(({ isInSight, target }) => !isInSight && target === 2)).toBe(true);
    const half = { normal: [-1, 0, 0] as const, offset: 2, reach: 0 };
    const finest = sightFrom(3, 0, { sides: [half] });
    const plan = planLeaves(leaves, [finest], 3 * 64);
    // Full detail wants all of it: bounds reach a little beyond a half, by the size of splats.
    expect(plan.map(({ isInSight }) => isInSight)).toEqual([true, true, true, false, false, false]);
    expect(plan.map(({ target }) => target)).toEqual([0, 0, 0, 2, 2, 2]);
    expect(targetsOf(leaves, [finest])).toEqual([0, 0, 0, 0, 0, 0]);
  });

  it('stays within the splats that a view draws, and comes near to them', () => {
    for (let run = 0; run < 40; run++) {
      const leaves = leavesOf(10);
      const splats = 12_000 + Math.floor(100_000 * random());
      const budget = { splats, isFinest: run % 2 === 0 };
      const targets = targetsOf(leaves, [sightFrom(10 * random(), 0.001, { budget })]);
      const drawn = targets.reduce((sum, level, i) => sum + leaves[i].levels[level].count, 0);
      expect(drawn).toBeLessThanOrEqual(splats);
      if (budget.isFinest) expect(drawn).toBeGreaterThan(splats - 12_288);
    }
  });

  it('refines a part after what it is a part of, for no more, and the lower rank first', () => {
    const bounds = { min: [0, 0, 0], max: [1, 1, 1] } as const;
    const leaf = (error: number, chunkCount: number, others: Partial<SceneLeaf> = {}): SceneLeaf => {
      const level = (count: number, each: number) => ({
        file: 0,
        count: 256 * count,
        chunkCount: count,
        error: each,
      });
      return { bounds, levels: [level(chunkCount, 0), level(1, error)], ...others };
    };
    const parts = [
      leaf(0.02, 8, { rank: 1 }),
      leaf(0.01, 8, { rank: 2 }),
      leaf(0.5, 8, { above: 1, rank: 9 }),
      leaf(0.5, 8, { above: 0, rank: 8 }),
      leaf(0.5, 8, { above: 0, rank: 7 }),
    ];
    const targets = (room: number, sight = sightFrom(-1, 1e-4)) => targetsOf(parts, [sight], room).join('');
    expect(targets(7)).toBe('11111');
    expect(targets(15)).toBe('01111');
    expect(targets(23)).toBe('01110');
    expect(targets(31)).toBe('01100');
    expect(targets(40)).toBe('00000');
    // What is above is good enough, or too large: then no part of it is refined.
    expect(targets(40, sightFrom(-1, 0.015))).toBe('01100');
    parts[0] = leaf(0.02, 80, { rank: 1 });
    expect(targets(40)).toBe('10011');
    // What the leaves above draw has the coarsest levels of their parts.
    const budget = { splats: 2 * 256 + 7 * 256, isFinest: true };
    expect(targets(anything, sightFrom(-1, 1e-4, { budget }))).toBe('10111');
  });

  it('has the environment at its only level', () => {
    const environment: SceneLeaf = { bounds: null, levels: [{ ...leavesOf(1)[0].levels[0] }] };
    expect(targetsOf([environment], [sightFrom(0, 0)])).toEqual([0]);
  });
});
