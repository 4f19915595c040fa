import type { BrickScene } from '../../data/bricks/brick.ts';
import { CHUNK_SPLATS } from '../../data/layout/constants.ts';
import { LEVEL_CONSTANTS, LevelCell } from '../../data/layout/level-structs.ts';
import { chunkCountOf } from '../../data/packing/chunks.ts';
import type { ShDegree } from '../../data/splats/splat-set.ts';
import { BLOB_WORDS, chunkBytes, LINKS_BYTES, shBytes } from '../stream/chunk-pages.ts';

const { CELL_CHILDREN } = LEVEL_CONSTANTS;
/**
 * Share of a pool for upper bricks. They are a sixteenth of a whole scene, and more of a partly
 * resident one.
 */
const UPPER_PART = 1 / 6;

/** Capacity of a pool in bricks. */
export interface PoolSlots {
  /** Bricks of the lowest level; `upper` counts bricks of all other levels. */
  readonly lowest: number;
  readonly upper: number;
}

/** Bytes per slot of a pool, for bricks of the lowest level and of any other. */
export function slotBytes(shDegree: ShDegree): { readonly lowest: number; readonly upper: number } {
  const blobBytes = 4 * BLOB_WORDS + shBytes(shDegree);
  return {
    lowest: CELL_CHILDREN * chunkBytes(shDegree),
    upper: CELL_CHILDREN * (LevelCell.bytes + 2 * (CHUNK_SPLATS * blobBytes + LINKS_BYTES)),
  };
}

/** Bytes of a pool with these slots. */
export function poolBytes(shDegree: ShDegree, { lowest, upper }: PoolSlots): number {
  const bytes = slotBytes(shDegree);
  return lowest * bytes.lowest + upper * bytes.upper + LevelCell.bytes;
}

/** Slots for the whole scene, or as many as the budget holds. */
export function slotsFor(scene: BrickScene, budgetBytes: number): PoolSlots {
  const { shDegree } = scene;
  const { least, most } = roomFor(scene);
  if (poolBytes(shDegree, most) <= budgetBytes) return most;
  const bytes = slotBytes(shDegree);
  const upper = Math.max(least.upper, Math.floor((UPPER_PART * budgetBytes) / bytes.upper));
  const slots = { lowest: 0, upper: Math.min(most.upper, upper) };
  return { ...slots, lowest: Math.floor((budgetBytes - poolBytes(shDegree, slots)) / bytes.lowest) };
}

/** Slots for the coarsest drawable state of a scene, and slots for all of it. */
export function roomFor({
  splatCount,
  brickCount,
}: BrickScene): Readonly<Record<'least' | 'most', PoolSlots>> {
  const chunks = chunkCountOf(splatCount);
  const lowest = Math.ceil(chunks / CELL_CHILDREN);
  const most = { lowest, upper: Math.max(1, brickCount - lowest) };
  // One brick of each level from the root down, and one spare to replace another.
  const levels = Math.ceil(Math.log(chunks) / Math.log(CELL_CHILDREN)) + 1;
  return { least: { lowest: Math.min(2, lowest), upper: Math.min(levels, most.upper) }, most };
}
