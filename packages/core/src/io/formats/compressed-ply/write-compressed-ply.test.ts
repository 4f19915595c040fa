import { expect, test } from 'vitest';
import { permuteSplats } from '../../../data/packing/morton-order.ts';
import type { ShDegree, SplatSet } from '../../../data/splats/splat-set.ts';
import { randomSplats, splatsOf } from '../../../testing/random-splats.ts';
import { splatErrors } from '../../../testing/splat-errors.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { chunkOrder, write } from './write-compressed-ply.ts';

const read = (bytes: Uint8Array) => readSplats(bytes, { name: 'scene', shPrecision: 'f32' });
const again = async (set: SplatSet) => read(await write(set, {}));
const inOrder = async (set: SplatSet) => permuteSplats(set, await chunkOrder(set, {}));

/** Rows of a chunk of 256. */
const chunkOf = <Kind extends SplatSet['harmonics']>(set: SplatSet<Kind>, first: number) =>
  permuteSplats(
    set,
    Uint32Array.from({ length: Math.min(256, set.count - first) }, (_, i) => first + i),
  );

/** The greatest difference of two values of any axis. */
function extentOf(column: Float32Array): number {
  const axes = [0, 1, 2].map((axis) => [...column].filter((_, i) => i % 3 === axis));
  return Math.max(...axes.map((values) => Math.max(...values) - Math.min(...values)));
}

test.each<ShDegree>([0, 1, 2, 3])('degree %i comes back within the steps of its chunk', async (shDegree) => {
  // The last chunk is not full.
  const set = randomSplats({ count: 600, shDegree, halfExtent: 40, logScales: [-12, 2] });
  set.rotations.fill(0, 0, 4);
  const found = await again(set);
  expect(found.fileFacts).toMatchObject({ format: 'compressed-ply', variant: 'binary_little_endian' });
  const expected = await inOrder(set);
  for (let first = 0; first < set.count; first += 256) {
    const chunk = chunkOf(expected, first);
    const errors = splatErrors(chunkOf(found as SplatSet<never>, first), chunk);
    // Half of the coarsest step each, and the rounding of float32.
    const rounding = (largest: number) => largest * 2 ** -23;
    expect(errors.position).toBeLessThanOrEqual(extentOf(chunk.positions) / 1023 / 2 + rounding(40));
    expect(errors.logScale).toBeLessThanOrEqual(extentOf(chunk.logScales) / 1023 / 2 + rounding(12));
    expect(errors.colorDc).toBeLessThanOrEqual(extentOf(chunk.colorDc) / 255 / 2 + rounding(4));
    expect(errors.opacity).toBeLessThanOrEqual(0.5 / 255 + 1e-7);
    // Three components are off by half a step of √2/1023, the fourth by up to twice as much as they
    // are together; the angle is twice the length of all that.
    const off = (Math.sqrt(3) * Math.SQRT2) / 1023 / 2;
    expect(errors.angle).toBeLessThanOrEqual(2 * Math.hypot(off, 2 * off));
    // Read as the middle of one of 256 steps from −4 to 4.
    expect(errors.firstHarmonics).toBeLessThanOrEqual(1 / 64);
    expect(errors.otherHarmonics).toBeLessThanOrEqual(1 / 64);
  }
});

test('a chunk whose values are all alike keeps them', async () => {
  const set = splatsOf(Array.from({ length: 300 }, () => ({ position: [1, -2, 0.1], colorDc: [0, 0, 0] })));
  const found = await again(set);
  expect(splatErrors(found, set)).toMatchObject({ position: 0, logScale: 0, colorDc: 0, opacity: 0 });
});

test('values out of range become the nearest ones', async () => {
  const harmonics = { degree: 1 as const, coefficients: Float32Array.of(9, -9, 4, -4, 0, 0, 0, 0, 0) };
  const set = { ...splatsOf([{ logScales: [-1e30, 1e30, 0] }]), harmonics };
  const found = await again(set);
  expect([...found.logScales]).toEqual([-20, 20, 0]);
  const words = new Float32Array(found.harmonics.words.buffer);
  expect([...words.subarray(0, 4)]).toEqual([4, -4, 4, -4]);
});

test.each([true, false, undefined])('antialiased: %s', async (isAntialiased) => {
  expect((await again({ ...randomSplats({ count: 1 }), isAntialiased })).isAntialiased).toBe(isAntialiased);
});

test('far from 0, coordinates are as coarse as float32', async () => {
  const set = randomSplats({ count: 300, origin: [4_500_000, -100_000, 0] });
  const { position } = splatErrors(await again(set), await inOrder(set));
  // Both bounds and the result are rounded to half of 1/2 there, and the steps are small.
  expect(position).toBeLessThanOrEqual(3 * 0.25 + 2 / 1023);
});
