/**
 * Makes and packs a built-in scene off the main thread, so that the page stays responsive. Where there are processors for
 * them, more workers of the same script make a share each.
 */
import {
  type AccuracySettings,
  type PackedCloud,
  packCloud,
  type SplatSet,
  transferablesOf,
} from '@websplatter/core';
import { mergeSplats } from '@websplatter/core/write';
import { builtinScene } from './make-builtin.ts';
import { numberOfShares } from './scene-shares.ts';

export interface SceneRequest extends Pick<AccuracySettings, 'geometryPrecision' | 'shPrecision'> {
  readonly name: string;
}

interface ShareRequest {
  readonly name: string;
  readonly share: number;
  readonly of: number;
}

export interface MadeScene {
  readonly packed: PackedCloud;
  /** The splats as they were made, from which other precisions can be packed. */
  readonly set: SplatSet;
}

self.onmessage = ({ data }: MessageEvent<SceneRequest | ShareRequest>) => {
  // So that whoever asked learns of an error.
  answer(data).catch(reportError);
};

async function answer(request: SceneRequest | ShareRequest): Promise<void> {
  if ('share' in request) {
    const set = builtinScene(request.name).makeShare(request.share, request.of);
    self.postMessage(set, { transfer: buffersOf(set) });
    return;
  }
  const { name, geometryPrecision, shPrecision } = request;
  const set = await makeInShares(name);
  const packed = packCloud(set, { geometryPrecision, shPrecision });
  // Precisions that are the same may share a buffer, which can be given away once.
  const transfer = [...new Set([...transferablesOf(packed), ...buffersOf(set)])];
  self.postMessage({ packed, set } satisfies MadeScene, { transfer });
}

async function makeInShares(name: string): Promise<SplatSet> {
  const { splats } = builtinScene(name);
  const of = numberOfShares(splats, navigator.hardwareConcurrency);
  const others = Array.from({ length: of - 1 }, (_, i) => shareOfWorker({ name, share: i + 1, of }));
  const own = builtinScene(name).makeShare(0, of);
  return mergeSplats([own, ...(await Promise.all(others))]) as SplatSet;
}

/** Made here where no worker can start, as in a page that may run no other script. */
function shareOfWorker(request: ShareRequest): Promise<SplatSet> {
  return new Promise((resolve) => {
    const makeHere = () => resolve(builtinScene(request.name).makeShare(request.share, request.of));
    let worker: Worker;
    try {
      worker = new Worker(self.location.href, { type: 'module' });
    } catch {
      makeHere();
      return;
    }
    worker.onmessage = ({ data }: MessageEvent<SplatSet>) => {
      worker.terminate();
      resolve(data);
    };
    worker.onerror = makeHere;
    worker.postMessage(request);
  });
}

function buffersOf(set: SplatSet): ArrayBufferLike[] {
  const { positions, logScales, rotations, opacityLogits, colorDc, fileIndices, harmonics } = set;
  const columns = [positions, logScales, rotations, opacityLogits, colorDc, fileIndices];
  return [...columns, harmonics.coefficients].map(({ buffer }) => buffer);
}
