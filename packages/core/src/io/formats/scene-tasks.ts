import type { BrickAddress } from '../../data/bricks/brick.ts';
import type { Turns } from '../../data/turns.ts';
import { type BrickFile, readBrick } from './bricks/decode-brick.ts';
import { fetchBricks } from './bricks/fetch-bricks.ts';
import { packFrame, readFrame } from './frames/pack-frame.ts';
import { divideRadPart } from './rad/divide-part.ts';
import { packRadNodes } from './rad/pack-nodes.ts';
import { fetchSogFile } from './sog/fetch-file.ts';
import { packSogLeaves } from './sog/pack-leaves.ts';

/** A brick before decoding. */
interface EncodedBrick {
  readonly file: BrickFile;
  readonly address: BrickAddress;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

/** The tasks of scene workers, by name. */
export const SCENE_TASKS = {
  decodeBrick: ({ bytes, address, file }: EncodedBrick, turns: Turns) =>
    readBrick(bytes, address, file, turns),
  fetchBricks,
  fetchSogFile,
  packSogLeaves,
  divideRadPart,
  packRadNodes,
  packFrame,
  readFrame,
};

export type SceneTasks = typeof SCENE_TASKS;

/** Tasks that mostly wait for the line. */
export const WAITING_TASKS: readonly (keyof SceneTasks)[] = ['fetchBricks', 'fetchSogFile'];
