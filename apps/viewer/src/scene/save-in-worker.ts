import { WebSplatterError } from '@websplatter/core';
import type { SaveReply, SaveRequest } from './save-messages.ts';
import { writeScene } from './write-scene.ts';

/** Reads a scene again and writes it as a file. Replies with every outcome and never throws. */
export async function save(
  request: SaveRequest,
  reply: (message: SaveReply, transfer: Transferable[]) => void,
): Promise<void> {
  try {
    const notes: string[] = [];
    const bytes = await writeScene(
      request,
      (progress) => reply({ kind: 'progress', ...progress }, []),
      (note) => notes.push(note),
    );
    reply({ kind: 'done', bytes, notes }, [bytes.buffer]);
  } catch (error) {
    const message = error instanceof Error ? error.message : String(error);
    reply({ kind: 'failed', message, isFault: !(error instanceof WebSplatterError) }, []);
  }
}
