import type { AccuracySettings } from '@websplatter/core';
import { type BuiltinSceneFacts, builtinSceneFacts } from '@websplatter/scenes';
import type { MadeScene, SceneRequest } from './builtin-scene.worker.ts';

export function findBuiltinScene(name: string): BuiltinSceneFacts | undefined {
  return builtinSceneFacts.find((scene) => scene.name === name);
}

/** A software rasteriser would need seconds per frame for the full scene. */
export function defaultSceneName(isSoftwareAdapter: boolean): string {
  return isSoftwareAdapter ? 'still-life-small' : 'still-life';
}

/** Computes and packs the scene for `accuracy` in a worker of its own, which an abort ends at once. */
export function makeBuiltinScene(
  name: string,
  { geometryPrecision, shPrecision }: AccuracySettings,
  signal: AbortSignal,
): Promise<MadeScene> {
  return new Promise((resolve, reject) => {
    signal.throwIfAborted();
    const worker = new Worker(new URL('./builtin-scene.worker.ts', import.meta.url), { type: 'module' });
    const finish = (settle: () => void) => {
      worker.terminate();
      signal.removeEventListener('abort', abort);
      settle();
    };
    const abort = () => finish(() => reject(signal.reason));
    signal.addEventListener('abort', abort);
    worker.onmessage = ({ data }: MessageEvent<MadeScene>) => finish(() => resolve(data));
    worker.onerror = (event) =>
      finish(() => reject(new Error(event.message || 'The worker could not be started.')));
    worker.postMessage({ name, geometryPrecision, shPrecision } satisfies SceneRequest);
  });
}
