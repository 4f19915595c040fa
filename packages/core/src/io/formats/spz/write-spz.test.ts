import { gunzipSync } from 'node:zlib';
import { expect, test } from 'vitest';
import { InvalidArgumentError } from '../../../data/errors.ts';
import type { ShDegree, SplatSet } from '../../../data/splats/splat-set.ts';
import { randomSplats, splatsOf } from '../../../testing/random-splats.ts';
import { splatErrors } from '../../../testing/splat-errors.ts';
import { readSplats } from '../../loading/read-splats.ts';
import { write } from './write-spz.ts';

const read = (bytes: Uint8Array) => readSplats(bytes, { name: 'scene.spz', shPrecision: 'f32' });
const again = async (set: SplatSet) => read(await write(set, {}));

test.each<ShDegree>([0, 1, 2, 3])('degree %i comes back within the steps of the format', async (shDegree) => {
  const set = randomSplats({
    count: 500,
    shDegree,
    halfExtent: 300,
    logScales: [-10, 5.9],
    origin: [7, 0, -1000],
  });
  // A rotation of zeros is the identity.
  set.rotations.fill(0, 0, 4);
  const found = await again(set);
  expect(found).toMatchObject({ fileFacts: { format: 'spz', variant: '3' }, isAntialiased: false });
  const errors = splatErrors(found, set);
  // Half a step each.
  expect(errors.position).toBeLessThanOrEqual(2 ** -13);
  expect(errors.logScale).toBeLessThanOrEqual(1 / 32);
  expect(errors.opacity).toBeLessThanOrEqual(0.5 / 255 + 1e-7);
  expect(errors.colorDc).toBeLessThanOrEqual(0.5 / 255 / 0.15 + 1e-6);
  // As in spz.test.ts: three parts are off by half a step, the fourth by up to twice their sum.
  const off = (Math.sqrt(3) * Math.SQRT1_2) / 511 / 2;
  expect(errors.angle).toBeLessThanOrEqual(2 * Math.hypot(off, 2 * off));
  // Half of 8/128 and 16/128.
  expect(errors.firstHarmonics).toBeLessThanOrEqual(4 / 128);
  expect(errors.otherHarmonics).toBeLessThanOrEqual(8 / 128);
});

test('splats of an SPZ are written as they were', async () => {
  const once = await again(randomSplats({ count: 300, shDegree: 3, opacityLogits: [-9, 9] }));
  const twice = await read(await write(once, {}));
  expect(twice.opacityLogits).toEqual(once.opacityLogits);
  expect(splatErrors(twice, once)).toEqual({
    ...{ position: 0, logScale: 0, opacity: 0, colorDc: 0, firstHarmonics: 0, otherHarmonics: 0 },
    angle: expect.closeTo(0, 6),
  });
});

test('values out of range become the nearest ones', async () => {
  const set = splatsOf([
    { logScales: [-30, 9, 0], colorDc: [-9, 9, 0], opacityLogit: Number.NEGATIVE_INFINITY },
    { logScales: [-10, 5.9375, 0], colorDc: [-0.5 / 0.15, 0.5 / 0.15, 0] },
  ]);
  const { logScales, colorDc, opacityLogits } = await again(set);
  expect(logScales.slice(0, 3)).toEqual(logScales.slice(3));
  expect(colorDc.slice(0, 3)).toEqual(colorDc.slice(3));
  expect(opacityLogits).toEqual(Float32Array.of(Number.NEGATIVE_INFINITY, Number.POSITIVE_INFINITY));
  const harmonics = { degree: 1 as const, coefficients: Float32Array.of(5, -5, 0, 0, 0, 0, 0, 0, 0) };
  const bytes = gunzipSync(await write({ ...splatsOf([{}]), harmonics }, {}));
  expect([...bytes.subarray(-9, -6)]).toEqual([255, 0, 128]);
});

test.each([true, false, undefined])('antialiased: %s', async (isAntialiased) => {
  const set = { ...randomSplats({ count: 1 }), isAntialiased };
  expect((await again(set)).isAntialiased).toBe(isAntialiased ?? false);
});

/**
 * @fault Files: splats that a format cannot hold
 * @consequence `InvalidArgumentError` with the splat and a remedy
 */
test('coordinates beyond 24 bits are refused, with the splat and what to do', async () => {
  const set = splatsOf([{ position: [2047.99, -2047.99, 0] }, { position: [0, -2048.1, 0] }]);
  const writing = write(set, {});
  await expect(writing).rejects.toThrow(InvalidArgumentError);
  await expect(writing).rejects.toThrow(/^Splat 1 has y = -2048\.1.*from -2048 to 2048\. Move or scale/);
});
