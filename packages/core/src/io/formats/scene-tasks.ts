import type { BrickAddress } from '../../data/bricks/brick.ts';
import type { Turns } from '../../data/turns.ts';
import { type BrickFile, readBrick } from './bricks/decode-brick.ts';
import type { CellColumns } from './cell-columns.ts';
import { packColumns } from './pack-columns.ts';

/** A brick before decoding. */
interface FetchedBrick {
  readonly file: BrickFile;
  readonly address: BrickAddress;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** The tasks of scene workers, by name. Each returns splats in GPU layout. */
export const SCENE_TASKS = {
  decodeBrick: ({ bytes, address, file }: FetchedBrick, turns: Turns) =>
    readBrick(bytes, address, file, turns),
  packCells: async (columns: CellColumns) => packColumns(columns),
};

export type SceneTasks = typeof SCENE_TASKS;
