/** Reads a scene again and writes it as a file, off the main thread. Ending the worker calls it off. */
import { WebSplatterError } from '@websplatter/core';
import type { SavingState } from '../state/saving.ts';
import { type SaveRequest, writeScene } from './write-scene.ts';

export type SaveReply =
  | ({ readonly kind: 'progress' } & Pick<SavingState, 'phase' | 'part'>)
  | { readonly kind: 'done'; readonly bytes: Uint8Array<ArrayBuffer> }
  /** `isFault`: nobody threw it on purpose. */
  | { readonly kind: 'failed'; readonly message: string; readonly isFault: boolean };

const reply = (message: SaveReply, transfer: Transferable[] = []) => self.postMessage(message, { transfer });

self.onmessage = async ({ data }: MessageEvent<SaveRequest>) => {
  try {
    const bytes = await writeScene(data, (progress) => reply({ kind: 'progress', ...progress }));
    reply({ kind: 'done', bytes }, [bytes.buffer]);
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    reply({ kind: 'failed', message, isFault: !(error instanceof WebSplatterError) });
  }
};
