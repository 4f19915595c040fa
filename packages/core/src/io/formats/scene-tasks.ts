import type { BrickAddress } from '../../data/bricks/brick.ts';
import type { Turns } from '../../data/turns.ts';
import { type BrickFile, readBrick } from './bricks/decode-brick.ts';
import type { CellColumns } from './cell-columns.ts';
import { packColumns } from './pack-columns.ts';

/** A brick as it was fetched. */
interface FetchedBrick {
  readonly file: BrickFile;
  readonly address: BrickAddress;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** What workers of scenes do, by name. All of it makes splats as they lie on the GPU. */
export const SCENE_TASKS = {
  decodeBrick: ({ bytes, address, file }: FetchedBrick, turns: Turns) =>
    readBrick(bytes, address, file, turns),
  packCells: async (columns: CellColumns) => packColumns(columns),
};

export type SceneTasks = typeof SCENE_TASKS;
