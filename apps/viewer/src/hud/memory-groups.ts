import type { EngineMemory } from '@websplatter/core';

/** Purposes of the GPU's memory. */
export const MEMORY_GROUPS = ['geometry', 'harmonics', 'bounds', 'frames', 'work'] as const;
export type MemoryGroup = (typeof MEMORY_GROUPS)[number];

/** Bytes of each group; together they are `totalBytes`. */
export function memoryByGroup({ totalBytes, scene, frames }: EngineMemory): Record<MemoryGroup, number> {
  const sum = (bytes: readonly number[]) => bytes.reduce((before, each) => before + each, 0);
  const ofClouds = (bytesOf: (cloud: EngineMemory['scene']['clouds'][number]) => readonly number[]) =>
    sum(scene.clouds.flatMap(bytesOf));
  return {
    geometry: ofClouds(({ geometryBytes }) => Object.values(geometryBytes)),
    harmonics: ofClouds(({ shBytes }) => Object.values(shBytes)),
    bounds: ofClouds(({ chunksBytes }) => [chunksBytes]),
    frames: frames.totalBytes,
    work: totalBytes - scene.totalBytes - frames.totalBytes,
  };
}
