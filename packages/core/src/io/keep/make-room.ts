import { type KeptScene, StorageRoomError } from './kept-scenes.ts';

/** Steps in which the room that is left is found. */
const STEPS = 16;

/** Storage that scenes can be removed from. */
interface SceneStorage {
  /** Whether so many bytes can be written. */
  readonly hasRoom: (byteCount: number) => Promise<boolean>;
  readonly remove: (scene: KeptScene) => Promise<unknown>;
}

/**
 * Makes room by removing scenes, the last first, until there is enough. Browsers do not tell how
 * much they have (Chromium 156 says 10 GiB, whatever the truth), so room is looked for by trying.
 *
 * @param others scenes that may go.
 * @param fileName for the message.
 *
 * Rejects with StorageRoomError if there is not enough even without them; none is removed then.
 */
export async function makeRoom(
  neededBytes: number,
  others: readonly KeptScene[],
  { hasRoom, remove }: SceneStorage,
  fileName: string,
): Promise<void> {
  if (await hasRoom(neededBytes)) return;
  const leftBytes = await roomUpTo(neededBytes, hasRoom);
  const mostBytes = others.reduce((sum, { bytes }) => sum + bytes, leftBytes);
  if (mostBytes >= neededBytes) {
    for (const scene of others.toReversed()) {
      await remove(scene);
      if (await hasRoom(neededBytes)) return;
    }
  }
  throw new StorageRoomError(fileName, neededBytes, mostBytes);
}

/** Bytes that can be written, of so many, in sixteenths. */
export async function roomUpTo(byteCount: number, hasRoom: SceneStorage['hasRoom']): Promise<number> {
  for (let step = STEPS - 1; step > 0; step--) {
    const bytes = Math.floor((step * byteCount) / STEPS);
    if (await hasRoom(bytes)) return bytes;
  }
  return 0;
}
