// Every layout that shaders read, byte by byte: readers and writers that change together pass all other
// tests of this folder.
import { describe, expect, test } from 'vitest';
import { packMotion } from '../../features/motion/pack-motion.data.ts';
import { MOTION_SLOT, MOTION_VALUES } from '../../features/motion/splat-motion.data.ts';
import { splatsOf } from '../../testing/random-splats.ts';
import { Chunk } from '../layout/structs.ts';
import { chunksOf } from './chunks.ts';
import { packGeometry } from './geometry.ts';
import { packCoefficients, paletteWordsOf, shWordsPerSplat } from './harmonics.ts';

/** The bytes of words in the order of memory, four and four. */
function hexOf(words: Uint32Array | Float32Array): string {
  return Buffer.from(words.buffer, words.byteOffset, words.byteLength)
    .toString('hex')
    .replace(/.{8}(?=.)/g, '$& ');
}

/** Turned by the unit quaternion (2, 4, 5, 6) / 9; every component and every axis has a value of its own. */
const SET = splatsOf([
  {
    position: [1, 2, -0.5],
    logScales: [-1, 1, -0.5],
    rotation: [4, 8, 10, 12],
    opacityLogit: 0,
    colorDc: [0.25, -1, 3],
  },
]);

test('geometry in float32: 64 bytes', () => {
  expect(hexOf(packGeometry(SET, 'f32').words)).toBe(
    // position, opacity 0.5
    '0000803f 00000040 000000bf 0000003f ' +
      // rotation w, x, y, z
      '398e633e 398ee33e e4380e3f abaa2a3f ' +
      // scale 1/e, e, e^-1/2, and padding
      'b25abc3e 54f82d40 98451b3f 00000000 ' +
      // colour of degree 0, and padding
      '0000803e 000080bf 00004040 00000000',
  );
});

test('packed geometry: 32 bytes', () => {
  expect(hexOf(packGeometry(SET, 'packed').words)).toBe(
    // position
    '0000803f 00000040 000000bf ' +
      // colour of degree 0 in binary16: 0.25, -1 | 3, and opacity 32768 of 65535
      '003400bc 00420080 ' +
      // log scales, steps 0, 65535 | 16384 of 65535, and the rotation: 21532 with bit 0 of the index 3
      '0000ffff 00401cd4 ' +
      // rotation: 26680 with bit 1 of the index, 29255
      '38e84772',
  );
});

for (const [left, expected] of [
  [0, '3868 47721c54'],
  [1, '1cd4 47723868'],
  [2, '1c54 38e84772'],
  [3, '1cd4 38e84772'],
] as const)
  test(`a rotation whose component ${left} is left out`, () => {
    const rotation = [2, 4, 5, 6];
    [rotation[left], rotation[3]] = [rotation[3], rotation[left]];
    const set = { ...SET, rotations: Float32Array.from(rotation) };
    expect(hexOf(packGeometry(set, 'packed').words).slice(-13)).toBe(expected);
  });

test('a chunk: 32 bytes', () => {
  // Least centre, least log scale, greatest centre, and 2/65535 per step.
  expect(hexOf(chunksOf(SET))).toBe(
    '0000803f 00000040 000000bf 000080bf 0000803f 00000040 000000bf 80000038',
  );
  const packed = Chunk.pack({
    minPosition: [1, 2, 3],
    minLogScale: 4,
    maxPosition: [5, 6, 7],
    logScaleStep: 8,
  });
  expect([...new Float32Array(packed)]).toEqual([1, 2, 3, 4, 5, 6, 7, 8]);
});

describe('harmonics of degree 1', () => {
  const values = [1, -0.5, 0.25, 2, -2, 0.125, 0.5, -1, 1.5];
  for (const [precision, expected] of [
    ['f32', '0000803f 000000bf 0000803e 00000040 000000c0 0000003e 0000003f 000080bf 0000c03f'],
    ['f16', '003c00b8 00340040 00c00030 003800bc 003e0000'],
    // The scale 2 in binary16, then 127ths of it.
    ['u8', '004040e0 107f8108 20c15f00'],
  ] as const)
    test(precision, () => {
      const words = new Uint32Array(shWordsPerSplat(1, precision));
      packCoefficients(1, precision, values, words, 0);
      expect(hexOf(words)).toBe(expected);
    });

  test('palette', () => {
    const entries = Float32Array.of(...values, ...values.toReversed());
    const indices = Uint16Array.of(9, 1, 0, 1);
    const words = paletteWordsOf({ degree: 1, precision: 'palette', entries, indices })(1, 4);
    expect([...new Float32Array(words.buffer, 0, 18)]).toEqual([...entries]);
    expect(hexOf(words.subarray(18))).toBe('01000000 01000000');
  });
});

test('motion: 64 bytes', () => {
  const motion = new Float32Array(MOTION_VALUES);
  motion[MOTION_SLOT.time] = 0.5;
  for (let k = 0; k < 9; k++) motion[MOTION_SLOT.velocity + k] = k + 1;
  motion.set([9, 18, 27, 45], MOTION_SLOT.turn);
  const { words } = packMotion({ ...SET, motion })!;
  expect(hexOf(words)).toBe(
    // velocity, time
    '0000803f 00000040 00004040 0000003f ' +
      // acceleration, 1 / duration
      '00008040 0000a040 0000c040 0000803f ' +
      // jerk, and padding
      '0000e040 00000041 00001041 00000000 ' +
      // turn w, x, y, z in the splat's own frame: (27.5, -3.5, 4.5, 1) / 9
      '398e4340 721cc7be 0000003f 398ee33d',
  );
});
