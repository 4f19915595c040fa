import type { EngineMemory } from '@websplatter/core';
import { expect, it } from 'vitest';
import { memoryByGroup } from './memory-groups.ts';

it('sums memory by what it is held for, over all clouds and precisions', () => {
  const memory: EngineMemory = {
    totalBytes: 1000,
    peakBytes: 2000,
    resources: [],
    scene: {
      totalBytes: 600,
      clouds: [
        {
          name: 'a',
          totalBytes: 400,
          geometryBytes: { f32: 100, packed: 50 },
          shBytes: { u8: 230 },
          chunksBytes: 20,
        },
        { name: 'b', totalBytes: 200, geometryBytes: { f32: 190 }, shBytes: {}, chunksBytes: 10 },
      ],
    },
    frames: { totalBytes: 300, views: [] },
  };
  expect(memoryByGroup(memory)).toEqual({
    geometry: 340,
    harmonics: 230,
    bounds: 30,
    frames: 300,
    work: 100,
  });
});
