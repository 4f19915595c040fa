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

export interface SceneRequest {
  readonly name: string;
  /** Absent where the scene will probably be asked for, but nobody has yet: it is made and kept. */
  readonly packing?: Pick<AccuracySettings, 'geometryPrecision' | 'shPrecision'>;
}

interface ShareRequest {
  readonly name: string;
  readonly share: number;
  readonly of: number;
}

export interface MadeScene {
  readonly name: string;
  readonly packed: PackedCloud;
  /** The splats as they were made, from which other precisions can be packed. */
  readonly set: SplatSet;
}

/** Requests are answered one after another. */
let turn = Promise.resolve();
let kept: { readonly name: string; readonly set: SplatSet } | null = null;

self.onmessage = ({ data }: MessageEvent<SceneRequest | ShareRequest>) => {
  // Whoever asked learns of an error.
  turn = turn.then(() => answer(data)).catch(reportError);
};

async function answer(request: SceneRequest | ShareRequest): Promise<void> {
  const { name } = request;
  if ('share' in request) {
    const set = builtinScene(name).makeShare(request.share, request.of);
    self.postMessage(set, { transfer: buffersOf(set) });
    return;
  }
  const set = kept?.name === name ? kept.set : await makeInShares(name);
  const { packing } = request;
  kept = packing ? null : { name, set };
  if (packing) post(name, set, packCloud(set, packing));
}

async function makeInShares(name: string): Promise<SplatSet> {
  const { splats } = builtinScene(name);
  const of = numberOfShares(splats, navigator.hardwareConcurrency);
  if (of === 1) return builtinScene(name).make();
  // This one makes none: a worker that is busy cannot start others.
  const shares = Array.from({ length: of }, (_, share) => shareOfWorker({ name, share, of }));
  return mergeSplats(await Promise.all(shares)) as SplatSet;
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
    worker.onerror = () => {
      worker.terminate();
      makeHere();
    };
    worker.postMessage(request);
  });
}

function post(name: string, set: SplatSet, packed: PackedCloud): void {
  // Precisions that are the same may share a buffer, which can be given away once.
  const transfer = [...new Set([...transferablesOf(packed), ...buffersOf(set)])];
  self.postMessage({ name, packed, set } satisfies MadeScene, { transfer });
}

function buffersOf(set: SplatSet): ArrayBufferLike[] {
  const { positions, logScales, rotations, opacityLogits, colorDc, fileIndices, harmonics } = set;
  const columns = [positions, logScales, rotations, opacityLogits, colorDc, fileIndices];
  return [...columns, harmonics.coefficients].map(({ buffer }) => buffer);
}
