import type { BrickResult, BrickTask } from '../formats/bricks/brick-tasks.ts';
import type { PostedError } from '../posted-error.ts';

/** Page to worker: its only job. */
export type KeepRequest =
  /** Convert a file to bricks. */
  | {
      readonly keep: 'scene';
      readonly key: string;
      readonly file: Blob;
      readonly fileName: string;
      /** Ports of helper workers. */
      readonly helpers: readonly MessagePort[];
    }
  /** Run the tasks that arrive through this port. */
  | { readonly keep: 'tasks'; readonly port: MessagePort };

/** Worker to page. */
export type KeepReply =
  /** The worker's script is running. */
  | { readonly kind: 'ready' }
  | { readonly kind: 'progress'; readonly fraction: number }
  | { readonly kind: 'kept' }
  | { readonly kind: 'no-room'; readonly neededBytes: number; readonly availableBytes: number }
  | { readonly kind: 'error'; readonly error: PostedError };

/** Message to a helper worker. */
export type HelperTask = BrickTask;
export type HelperAnswer = { readonly result: BrickResult } | { readonly error: PostedError };

/** The part of a worker's global scope that is used. */
export interface KeepPort {
  onmessage: ((event: MessageEvent<KeepRequest>) => void) | null;
  postMessage(reply: KeepReply): void;
}
