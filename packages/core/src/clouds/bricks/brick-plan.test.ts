import { beforeAll, describe, expect, it } from 'vitest';
import type { BrickAddress } from '../../data/bricks/brick.ts';
import { brickSceneOf } from '../../data/bricks/make-bricks.ts';
import { cellThreshold } from '../../stages/cut/cut.reference.ts';
import { randomSplats } from '../../testing/random-splats.ts';
import { seededRandom } from '../../testing/seeded-random.ts';
import type { CloudSight } from '../stream/cloud-sight.ts';
import { BrickPlan, isWorthMore } from './brick-plan.ts';
import type { PlacedBrick, PlacedCell } from './brick-pool.ts';

const scene = brickSceneOf(randomSplats({ count: 20_000, seed: 6, shDegree: 0, logScales: [-6, -3] }));
const random = seededRandom(2);

/** The tree of bricks down to this number of levels, as if it were on the GPU. */
async function placed(
  address: BrickAddress,
  levels: number,
  above: PlacedCell | null = null,
): Promise<PlacedBrick> {
  const { level, cells } = await scene.read(address);
  const brick: PlacedBrick & { cells: PlacedCell[] } = { address, level, slot: 0, cells: [], above };
  brick.cells = cells.map((cell) => ({ ...cell, brick, cell: 0, below: null }));
  for (const cell of brick.cells)
    if (cell.child && levels > 1) cell.below = await placed(cell.child, levels - 1, cell);
  return brick;
}

function cellsBelow({ cells }: PlacedBrick): PlacedCell[] {
  return cells.flatMap((cell) => [cell, ...(cell.below ? cellsBelow(cell.below) : [])]);
}

function sightFrom(camera: readonly [number, number, number], sides: CloudSight['sides'] = []): CloudSight {
  const cut = { camera, squaredPerDistance: 10 ** (-5 * random()), leastSquared: 1e-12, margin: 0 };
  return { cut, squaredShift: 1, sides };
}

const anywhere = () => [0, 1, 2].map(() => 6 * random() - 3) as [number, number, number];
const cutAt = (offset: number) => [{ normal: [1, 0, 0] as const, offset, reach: 2 }];

describe('the demand for bricks', () => {
  let whole: PlacedBrick;
  beforeAll(async () => {
    whole = await placed(scene.root, 9);
    expect(cellsBelow(whole).length).toBeGreaterThan(80);
  });

  it('wants what the cut would draw, and nothing else', () => {
    const wants = [0, 0];
    for (let run = 0; run < 30; run++) {
      const sight = sightFrom(anywhere());
      const demand = new BrickPlan([sight]);
      for (const cell of cellsBelow(whole)) {
        if (!cell.child) continue;
        const isDrawn = cellThreshold(cell.bounds, sight.cut) < Math.max(...cell.childErrors);
        expect(demand.valueOf(cell) > 1).toBe(isDrawn);
        wants[Number(isDrawn)]++;
      }
    }
    expect(Math.min(...wants)).toBeGreaterThan(50);
  });

  it('never wants a brick more than its parent', () => {
    for (let run = 0; run < 30; run++) {
      const sights = [sightFrom(anywhere(), cutAt(2 * random() - 1)), sightFrom(anywhere(), cutAt(0))];
      const demand = new BrickPlan(sights);
      for (const { cells, above } of cellsBelow(whole).flatMap(({ below }) => below ?? []))
        for (const cell of cells)
          if (cell.child) expect(demand.valueOf(cell)).toBeLessThanOrEqual(demand.valueOf(above!));
    }
  });

  it('lists what is missing below what is there, the most valuable first', async () => {
    const some = await placed(scene.root, 2);
    const demand = new BrickPlan([sightFrom([0, 0, 1.5])]);
    const lacking = demand.lacking(some);
    const wanted = cellsBelow(some).filter((cell) => cell.child && !cell.below && demand.valueOf(cell) > 1);
    expect(lacking.length).toBeGreaterThan(3);
    expect(new Set(lacking.map(({ above }) => above))).toEqual(new Set(wanted));
    for (const [i, each] of lacking.slice(1).entries()) expect(isWorthMore(lacking[i], each)).toBe(true);
    expect(new BrickPlan([]).lacking(some)).toEqual([]);
  });

  it('wants less of what is out of sight, beyond a budget, or seen by no view', () => {
    const cell = whole.cells[0];
    const camera = [0, 0, 3] as const;
    const sight = sightFrom(camera);
    const value = (sights: readonly CloudSight[]) => new BrickPlan(sights).valueOf(cell);
    const seen = value([sight]);
    expect(value([{ ...sight, sides: cutAt(-50) }])).toBeCloseTo(1e-12 * seen, 15);
    expect(value([{ ...sight, squaredShift: 4 }])).toBeCloseTo(seen / 4, 9);
    expect(value([])).toBe(0);
    expect(value([{ ...sight, sides: cutAt(-50) }, sight])).toBe(seen);
  });

  it('ranks what is there by value, and leaves the root out', () => {
    const bricks = [whole, ...cellsBelow(whole).flatMap(({ below }) => below ?? [])];
    const demand = new BrickPlan([sightFrom(anywhere())]);
    const ranked = demand.ranked(bricks);
    expect(ranked).toHaveLength(bricks.length - 1);
    for (const [i, each] of ranked.slice(1).entries()) expect(isWorthMore(each, ranked[i])).toBe(true);
  });

  it('ranks by errors in pixels where none is allowed, and wants nothing out of sight', () => {
    const valued = (offset: number, squaredShift: number) => {
      const demand = new BrickPlan([{ ...sightFrom([0.3, -0.2, 1], cutAt(offset)), squaredShift }]);
      const cells = cellsBelow(whole).filter(({ child }) => child);
      return cells
        .map((cell) => ({ number: cell.child!.number, value: demand.valueOf(cell) }))
        .sort((a, b) => (isWorthMore(a, b) ? -1 : 1));
    };
    const numbers = (bricks: ReturnType<typeof valued>) => bricks.map(({ number }) => number);
    const seen = valued(0, 0);
    expect(seen.every(({ value }) => value > 1)).toBe(true);
    expect(numbers(seen)).toEqual(numbers(valued(0, 1)));
    expect(numbers(seen)).not.toEqual([...numbers(seen)].sort((a, b) => a - b));
    expect(valued(-2.5, 0).some(({ value }) => value > 1)).toBe(false);
  });

  it('wants what is foreseen after all that it would draw, and before the rest', async () => {
    const some = await placed(scene.root, 2);
    const soon = sightFrom([0, 0, 1.5]);
    // As coarse as to need two bricks.
    const now = { ...soon, squaredShift: new BrickPlan([soon]).lacking(some)[2].value };
    const numbers = (bricks: readonly { readonly number: number }[]) => bricks.map(({ number }) => number);
    const blind = new BrickPlan([now]);
    const demand = new BrickPlan([now], [soon]);
    const lacking = demand.lacking(some, true);
    const needed = lacking.filter(({ value }) => value > 1);
    expect(needed).toEqual(blind.lacking(some));
    expect(lacking.slice(0, needed.length)).toEqual(needed);
    expect(demand.lacking(some)).toEqual(needed);
    const ahead = new Set(numbers(new BrickPlan([soon]).lacking(some)));
    expect(new Set(numbers(lacking))).toEqual(new Set([...numbers(needed), ...ahead]));
    expect(needed).toHaveLength(2);
    expect(lacking.length).toBeGreaterThan(2);
    expect(numbers(blind.lacking(some, true))).toEqual(numbers(needed));
    for (const { cells, above } of cellsBelow(whole).flatMap(({ below }) => below ?? []))
      for (const cell of cells)
        if (cell.child) expect(demand.valueOf(cell)).toBeLessThanOrEqual(demand.valueOf(above!));
  });
});
