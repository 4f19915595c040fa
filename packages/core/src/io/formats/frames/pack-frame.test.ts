// Proves: a cloud with some other columns is, to the bit, the cloud that is packed with them.
import { describe, expect, test } from 'vitest';
import { cloudFacts } from '../../../data/packing/cloud-facts.ts';
import { packStored } from '../../../data/packing/packed-cloud.ts';
import { packHarmonics } from '../../../data/packing/repack-harmonics.ts';
import type { SplatColumns } from '../../../data/splats/splat-set.ts';
import { randomSplats } from '../../../testing/random-splats.ts';
import { changedCloud } from './pack-frame.ts';

const COUNT = 600;
const [BEFORE, AFTER] = [1, 2].map((seed) => randomSplats({ count: COUNT, seed, shDegree: 1 }));
const HARMONICS = packHarmonics(BEFORE.harmonics);

function packed(columns: Partial<SplatColumns>, precision: 'f32' | 'packed') {
  const set = { ...BEFORE, harmonics: HARMONICS, ...columns };
  return packStored(set, cloudFacts(set), precision);
}

const COLUMNS = ['positions', 'logScales', 'rotations', 'opacityLogits', 'colorDc'] as const;
/** All that have positions where they have log scales. */
const SUBSETS = Array.from({ length: 2 ** COLUMNS.length }, (_, bits) =>
  COLUMNS.filter((_, i) => (bits >> i) % 2 === 1),
).filter((names) => names.includes('positions') || !names.includes('logScales'));

describe.each(['f32', 'packed'] as const)('%s', (precision) => {
  test.each(SUBSETS.map((names) => [names.join(', ') || 'nothing', names] as const))('%s', (_, names) => {
    const changed = Object.fromEntries(names.map((name) => [name, AFTER[name]]));
    const cloud = packed({}, precision);
    const result = changedCloud(cloud, { count: COUNT, ...changed });
    expect(result).toEqual(packed(changed, precision));
    expect(result.geometry.chunks.buffer).toBe(result.chunks);
    // The cloud before is left as it was, and shares no memory that may be transferred.
    expect(cloud).toEqual(packed({}, precision));
    expect(result.harmonics).not.toBe(cloud.harmonics);
  });
});

test('splats that become round are known as such', () => {
  const logScales = new Float32Array(3 * COUNT).fill(-4);
  const { positions } = BEFORE;
  const { facts } = changedCloud(packed({}, 'packed'), { count: COUNT, positions, logScales });
  expect(facts.isIsotropic).toBe(true);
});
