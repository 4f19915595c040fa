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

/** Scenes that look like another one and are made much sooner: they are shown until that is there. */
const DRAFTS: Readonly<Record<string, string>> = { 'still-life': 'still-life-small' };

/** A worker that has begun to make a scene that will probably be asked for. */
let foreseeing: Worker | null = null;

/** Begins to make `name`, or its draft: it will probably be asked for. */
export function foreseeBuiltinScene(name: string): void {
  foreseeing = startWorker();
  foreseeing.postMessage({ name: DRAFTS[name] ?? name } satisfies SceneRequest);
}

/**
 * Computes and packs the scene for `accuracy` in a worker of its own, which an abort ends at once.
 *
 * @param onDraft called with what looks like the scene, where making that takes long.
 */
export function makeBuiltinScene(
  name: string,
  { geometryPrecision, shPrecision }: AccuracySettings,
  signal: AbortSignal,
  onDraft: (draft: MadeScene) => void,
): Promise<MadeScene> {
  return new Promise((resolve, reject) => {
    signal.throwIfAborted();
    const worker = foreseeing ?? startWorker();
    foreseeing = null;
    const finish = (settle: () => void) => {
      worker.terminate();
      signal.removeEventListener('abort', abort);
      settle();
    };
    const abort = () => finish(() => reject(signal.reason));
    signal.addEventListener('abort', abort);
    worker.onmessage = ({ data }: MessageEvent<MadeScene>) => {
      if (data.name === name) {
        finish(() => resolve(data));
        return;
      }
      try {
        onDraft(data);
      } catch (error) {
        finish(() => reject(error));
      }
    };
    worker.onerror = (event) =>
      finish(() => reject(new Error(event.message || 'The worker could not be started.')));
    const packing = { geometryPrecision, shPrecision };
    const names = DRAFTS[name] ? [DRAFTS[name], name] : [name];
    for (const each of names) worker.postMessage({ name: each, packing } satisfies SceneRequest);
  });
}

function startWorker(): Worker {
  return new Worker(new URL('./builtin-scene.worker.ts', import.meta.url), { type: 'module' });
}
