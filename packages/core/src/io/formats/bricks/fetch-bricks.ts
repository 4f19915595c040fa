import type { Brick, BrickAddress } from '../../../data/bricks/brick.ts';
import type { Turns } from '../../../data/turns.ts';
import { type PostedError, toPostedError } from '../../posted-error.ts';
import { type RemoteFacts, RemoteFile } from '../../sources/remote-file.ts';
import { type BrickFile, readBrick } from './decode-brick.ts';

/** Adjacent bricks of a file on a server. Can be posted. */
interface FetchedBricks {
  readonly file: BrickFile;
  readonly remote: RemoteFacts;
  readonly addresses: readonly BrickAddress[];
}

/** A decoded brick, or why there is none, by its index in `addresses`. Can be posted. */
export type BrickOutcome = { readonly index: number } & (
  | { readonly brick: Brick }
  | { readonly error: PostedError }
);

/**
 * Fetches bricks, and hands on each as soon as its bytes have arrived and are decoded. A damaged
 * brick does not hold others up.
 *
 * Rejects with SplatSourceError, and with the reason of the turns' signal.
 */
export async function fetchBricks(
  { file, remote, addresses }: FetchedBricks,
  turns: Turns,
  onProgress: (outcome: BrickOutcome) => void,
): Promise<void> {
  const decode = async (index: number, bytes: Uint8Array<ArrayBuffer>) => {
    try {
      onProgress({ index, brick: await readBrick(bytes, addresses[index], file, turns) });
    } catch (error) {
      onProgress({ index, error: toPostedError(error) });
    }
  };
  const decodings: Promise<void>[] = [];
  try {
    const give = (index: number, bytes: Uint8Array<ArrayBuffer>) => decodings.push(decode(index, bytes));
    await new RemoteFile(remote).readRun(addresses, turns.signal, give);
  } finally {
    await Promise.all(decodings);
  }
}
