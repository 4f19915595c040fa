import type { BrickResult, BrickTask } from '../formats/bricks/brick-tasks.ts';
import type { PostedError } from '../loading/load-messages.ts';

/** Page to worker: what it is to do until it is ended. */
export type KeepRequest =
  /** Arrange a file for streaming. */
  | {
      readonly keep: 'scene';
      readonly key: string;
      readonly file: Blob;
      readonly fileName: string;
      /** Of workers that help. */
      readonly helpers: readonly MessagePort[];
    }
  /** Do the tasks that come through this port. */
  | { readonly keep: 'tasks'; readonly port: MessagePort };

/** Worker to page. */
export type KeepReply =
  /** The worker's script is running. */
  | { readonly kind: 'ready' }
  | { readonly kind: 'progress'; readonly fraction: number }
  | { readonly kind: 'kept' }
  | { readonly kind: 'no-room'; readonly neededBytes: number; readonly availableBytes: number }
  | { readonly kind: 'error'; readonly error: PostedError };

/** Through the port of a helper. */
export type HelperTask = BrickTask;
export type HelperAnswer = { readonly result: BrickResult } | { readonly error: PostedError };

/** The part of a worker's global scope that is used. */
export interface KeepPort {
  onmessage: ((event: MessageEvent<KeepRequest>) => void) | null;
  postMessage(reply: KeepReply): void;
}
