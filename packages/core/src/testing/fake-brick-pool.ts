import type { PlacedBrick, PlacedCell, PoolSlots } from '../clouds/bricks/brick-pool.ts';
import type { Brick, BrickAddress } from '../data/bricks/brick.ts';

/** Room for bricks, without a GPU. */
export class FakeBrickPool {
  readonly slots: PoolSlots;
  readonly bricks: PlacedBrick[] = [];
  /** By number, of all that were placed. */
  readonly contents: Brick[] = [];

  constructor(slots: PoolSlots = { lowest: 1000, upper: 1000 }) {
    this.slots = slots;
  }

  async ready(): Promise<void> {}

  async whenDone(): Promise<void> {}

  freeSlots(level: number): number {
    const taken = this.bricks.filter((brick) => (brick.level === 0) === (level === 0)).length;
    return (level === 0 ? this.slots.lowest : this.slots.upper) - taken;
  }

  place(
    brick: Brick,
    address: BrickAddress,
    above: PlacedCell | null,
    instead: PlacedBrick | null = null,
  ): PlacedBrick {
    if (instead) this.remove(instead);
    const placed: PlacedBrick & { cells: PlacedCell[] } = { address, ...brick, slot: 0, cells: [], above };
    placed.cells = brick.cells.map((cell) => ({ ...cell, brick: placed, cell: 0, below: null }));
    if (above) above.below = placed;
    this.bricks.push(placed);
    this.contents[address.number] = brick;
    return placed;
  }

  merge(): void {}

  remove(brick: PlacedBrick): void {
    for (const { below } of brick.cells) if (below) this.remove(below);
    if (brick.above) brick.above.below = null;
    this.bricks.splice(this.bricks.indexOf(brick), 1);
  }
}
