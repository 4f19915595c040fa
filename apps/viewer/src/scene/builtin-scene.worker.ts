/** Makes and packs a built-in scene off the main thread, so that the page stays responsive. */
import {
  type AccuracySettings,
  type PackedCloud,
  packCloud,
  type SplatSet,
  transferablesOf,
} from '@websplatter/core';
import { makeBuiltin } from './make-builtin.ts';

export interface SceneRequest extends Pick<AccuracySettings, 'geometryPrecision' | 'shPrecision'> {
  readonly name: string;
}

export interface MadeScene {
  readonly packed: PackedCloud;
  /** The splats as they were made, from which other precisions can be packed. */
  readonly set: SplatSet;
}

self.onmessage = ({ data }: MessageEvent<SceneRequest>) => {
  const { name, geometryPrecision, shPrecision } = data;
  const set = makeBuiltin(name);
  const packed = packCloud(set, { geometryPrecision, shPrecision });
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
  self.postMessage({ packed, set } satisfies MadeScene, { transfer });
};
