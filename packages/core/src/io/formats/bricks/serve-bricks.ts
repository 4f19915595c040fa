import type { Brick, BrickAddress } from '../../../data/bricks/brick.ts';
import { Turns } from '../../../data/turns.ts';
import { type PostedError, toPostedError } from '../../loading/load-messages.ts';
import { type BrickFile, readBrick } from './decode-brick.ts';

/** Page to worker. */
export type BrickRequest =
  | {
      readonly brick: 'decode';
      /** Of the request: the reply has it, too. */
      readonly id: number;
      readonly file: BrickFile;
      readonly address: BrickAddress;
      readonly bytes: Uint8Array<ArrayBuffer>;
    }
  /** Nothing waits for that reply any more. */
  | { readonly brick: 'drop'; readonly id: number };

/** Worker to page. */
export type BrickReply =
  /** The worker's script is running. */
  | { readonly kind: 'ready' }
  | { readonly kind: 'brick'; readonly id: number; readonly brick: Brick }
  | { readonly kind: 'error'; readonly id: number; readonly error: PostedError };

/** The part of a worker's global scope that is used; a MessagePort has it too. */
export interface BrickPort {
  onmessage: ((event: MessageEvent<BrickRequest>) => void) | null;
  postMessage(reply: BrickReply, transfer: Transferable[]): void;
}

/** Decodes the bricks that the page asks for, one after another. */
export function serveBricks(port: BrickPort): void {
  /** Of the replies that the page waits for. */
  const endings = new Map<number, AbortController>();
  let last: Promise<void> = Promise.resolve();
  const answer = async (request: Extract<BrickRequest, { brick: 'decode' }>, signal: AbortSignal) => {
    const { id, file, address, bytes } = request;
    try {
      signal.throwIfAborted();
      const brick = await readBrick(bytes, address, file, new Turns(signal));
      const { geometry, harmonics, rows } = brick;
      port.postMessage(
        { kind: 'brick', id, brick },
        [geometry, harmonics, rows].map(({ buffer }) => buffer),
      );
    } catch (error) {
      port.postMessage({ kind: 'error', id, error: toPostedError(error) }, []);
    } finally {
      endings.delete(id);
    }
  };
  port.onmessage = ({ data: request }) => {
    if (request.brick === 'drop') {
      endings.get(request.id)?.abort();
      return;
    }
    const ending = new AbortController();
    endings.set(request.id, ending);
    last = last.then(() => answer(request, ending.signal));
  };
  port.postMessage({ kind: 'ready' }, []);
}
