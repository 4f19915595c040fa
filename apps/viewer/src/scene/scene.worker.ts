/**
 * Reads a scene again, off the main thread, and writes it as a file or answers questions about its
 * splats. Both tasks share a script, so that the readers of all formats are downloaded once.
 * Terminating the worker cancels all work.
 */
import type { InspectRequest } from './inspect-messages.ts';
import type { SaveReply, SaveRequest } from './save-messages.ts';

export type SceneRequest = SaveRequest | InspectRequest;

let answering: Promise<typeof import('./answer-in-worker.ts')> | null = null;

self.onmessage = async ({ data }: MessageEvent<SceneRequest>) => {
  if (data.kind === 'save') {
    const { save } = await import('./save-in-worker.ts');
    await save(data, (message: SaveReply, transfer: Transferable[]) =>
      self.postMessage(message, { transfer }),
    );
    return;
  }
  // One promise for all messages: two imports of a module may resolve in another order, and
  // questions must follow the request to read the scene.
  answering ??= import('./answer-in-worker.ts');
  const { answer } = await answering;
  await answer(data, (message) => self.postMessage(message));
};
