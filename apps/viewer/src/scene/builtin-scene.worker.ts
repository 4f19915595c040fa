/** Makes and packs built-in scenes off the main thread, so that the page stays responsive. */
import {
  type AccuracySettings,
  type PackedCloud,
  packCloud,
  type SplatSet,
  transferablesOf,
} from '@websplatter/core';
import { makeBuiltin } from './make-builtin.ts';

export interface SceneRequest {
  readonly name: string;
  /** Absent where the scene will probably be asked for, but nobody has yet: it is made and kept. */
  readonly packing?: Pick<AccuracySettings, 'geometryPrecision' | 'shPrecision'>;
}

export interface MadeScene {
  readonly name: string;
  readonly packed: PackedCloud;
  /** The splats as they were made, from which other precisions can be packed. */
  readonly set: SplatSet;
}

let kept: { readonly name: string; readonly set: SplatSet } | null = null;

self.onmessage = ({ data }: MessageEvent<SceneRequest>) => {
  const { name, packing } = data;
  const set = kept?.name === name ? kept.set : makeBuiltin(name);
  kept = packing ? null : { name, set };
  if (packing) post(name, set, packCloud(set, packing));
};

function post(name: string, set: SplatSet, packed: PackedCloud): void {
  const columns = [
    set.positions,
    set.logScales,
    set.rotations,
    set.opacityLogits,
    set.colorDc,
    set.fileIndices,
  ];
  const buffers = [...columns, set.harmonics.coefficients].map(({ buffer }) => buffer);
  // Precisions that are the same may share a buffer, which can be given away once.
  const transfer = [...new Set([...transferablesOf(packed), ...buffers])];
  self.postMessage({ name, packed, set } satisfies MadeScene, { transfer });
}
